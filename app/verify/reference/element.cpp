// SPDX-License-Identifier: MIT
#include "app/verify/reference/element.hpp"

#include <cmath>
#include <numbers>

namespace dampline::sim::reference {

namespace {

constexpr Real kHalfPi = std::numbers::pi_v<Real> / 2;

}  // namespace

Real signum(Signum kind, Real sharpness_spm, Real v_mps) noexcept {
  const Real u = sharpness_spm * v_mps;
  switch (kind) {
    case Signum::kExact:
      return static_cast<Real>(v_mps > 0) - static_cast<Real>(v_mps < 0);
    case Signum::kTanh:
      return std::tanh(u);
    case Signum::kErf:
      return std::erf(u);
    case Signum::kArctangent:
      return std::atan(u) / kHalfPi;
    case Signum::kRational:
      return u / (1 + std::abs(u));
  }
  return 0;
}

Real smooth_force(const Element& element, Real z, Real v) noexcept {
  const Real spring = z * (element.k + z * (element.k2 + z * element.k3));
  const Real damper = v * (element.c + v * (element.c2 + v * element.c3));
  return spring + damper + z * v * (element.d + z * element.w);
}

Real hold_force(const Element& element, Branch branch, Real z) noexcept {
  return element.e + element.fk * static_cast<Real>(branch.of_stretch) * z + element.t;
}

Real friction_force(const Element& element, Branch branch, Real z, Real v) noexcept {
  if (!element.has_friction() || branch.of_rate == 0) return 0;
  const Real speed = static_cast<Real>(branch.of_rate) * v;
  Real size = element.e + element.fk * static_cast<Real>(branch.of_stretch) * z;
  if (element.t != 0) size += element.t * std::exp(-element.a_spm * speed);
  switch (element.signum) {
    case Signum::kExact:
      return size * static_cast<Real>(branch.of_rate);
    case Signum::kRational:  // on the branch, also where a stage reaches beyond it
      return size * element.sharpness_spm * v / (1 + element.sharpness_spm * speed);
    case Signum::kTanh:
    case Signum::kErf:
    case Signum::kArctangent:
      return size * signum(element.signum, element.sharpness_spm, v);
  }
  return 0;
}

Real force_n(const Input& input, Real time_s) noexcept {
  Real sum = 0;
  for (const Sine& sine : input) {
    const Real phase = (sine.rate_radps + 0.5L * sine.slope_radps2 * time_s) * time_s;
    sum += sine.amplitude_n * std::sin(phase);
  }
  return sum;
}

}  // namespace dampline::sim::reference

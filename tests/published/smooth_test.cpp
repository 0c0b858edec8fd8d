// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/verify/reference/chain.hpp"

namespace dampline::sim::reference {
namespace {

Chain single(const Element& element, const Input& input = {}) {
  Chain chain{.mass_kg = {1}, .links = {{Link::kGround, 0, element}}};
  if (!input.empty()) chain.inputs = {input};
  return chain;
}

/// Largest distance of the deflection from cos(t), from x = 1 at rest.
double error_of_cosine(std::size_t substeps) {
  const Trajectory found =
      simulate(single({.k = 1}), {{1}, {0}}, {.step_s = 2.0, .samples = 6, .substeps = substeps});
  double worst = 0.0;
  for (std::size_t n = 0; n < found.deflection_m[0].size(); ++n) {
    worst = std::max(worst, std::abs(found.deflection_m[0][n] - std::cos(2.0 * double(n))));
  }
  return worst;
}

TEST(RungeKutta, IsOfOrderEight) {
  EXPECT_NEAR(std::log2(error_of_cosine(2) / error_of_cosine(4)), 8.0, 0.3);
  EXPECT_NEAR(std::log2(error_of_cosine(4) / error_of_cosine(8)), 8.0, 0.3);
}

TEST(RungeKutta, MeetsAForcedDampedOscillatorToTheLastDigit) {
  // x'' + 2 d x' + k x = F sin(w t), from rest.
  constexpr Real kDamping = 0.63L;
  constexpr Real kStiffness = 25;
  constexpr Real kDrive = 4 * std::numbers::pi_v<Real>;
  const Trajectory found = simulate(single({.k = kStiffness, .c = 2 * kDamping}, {{1, kDrive, 0}}),
                                    {}, {.step_s = 0.01, .samples = 2000, .substeps = 8});
  const Real real = kStiffness - kDrive * kDrive;
  const Real imaginary = 2 * kDamping * kDrive;
  const Real scale = 1 / (real * real + imaginary * imaginary);
  const Real in_phase = real * scale;
  const Real across = -imaginary * scale;
  const Real own = std::sqrt(kStiffness - kDamping * kDamping);
  const Real a = -across;
  const Real b = (kDamping * a - in_phase * kDrive) / own;
  for (std::size_t n = 0; n < found.deflection_m[0].size(); ++n) {
    const Real t = static_cast<Real>(n) * static_cast<Real>(0.01);
    const Real x = in_phase * std::sin(kDrive * t) + across * std::cos(kDrive * t) +
                   std::exp(-kDamping * t) * (a * std::cos(own * t) + b * std::sin(own * t));
    ASSERT_NEAR(found.deflection_m[0][n], static_cast<double>(x), 2e-17) << n;
    ASSERT_EQ(found.force_n[0][n], static_cast<double>(std::sin(kDrive * t))) << n;
  }
}

TEST(RungeKutta, KeepsTheEnergyOfAFreeDuffingOscillator) {
  constexpr double kCubic = 0.7;
  const Trajectory found =
      simulate(single({.k = 1, .k3 = static_cast<Real>(kCubic)}), {{1.5L}, {0}},
               {.step_s = 0.1, .samples = 1000, .substeps = 16});
  const auto energy = [&](std::size_t n) {
    const double x = found.deflection_m[0][n];
    const double v = found.velocity_mps[0][n];
    return v * v / 2 + x * x / 2 + kCubic * x * x * x * x / 4;
  };
  for (std::size_t n = 0; n < 1000; ++n) ASSERT_NEAR(energy(n), energy(0), 2e-15) << n;
}

TEST(RungeKutta, MeetsThePeriodOfTheDuffingOscillator) {
  // T = 4 K(m) / sqrt(k + k3 A^2), m = k3 A^2 / (2 (k + k3 A^2)).
  constexpr Real kStiffness = 2;
  constexpr Real kCubic = 3;
  constexpr Real kAmplitude = 1.25L;
  const Real stiff = kStiffness + kCubic * kAmplitude * kAmplitude;
  const Real modulus = std::sqrt(kCubic * kAmplitude * kAmplitude / (2 * stiff));
  const Real period_s = 4 * std::comp_ellint_1(modulus) / std::sqrt(stiff);
  const auto step_s = static_cast<double>(period_s / 64);
  const Trajectory found = simulate(single({.k = kStiffness, .k3 = kCubic}), {{kAmplitude}, {0}},
                                    {.step_s = step_s, .samples = 65, .substeps = 8});
  EXPECT_NEAR(found.deflection_m[0][64], 1.25, 1e-15);
  EXPECT_NEAR(found.deflection_m[0][32], -1.25, 1e-15);
  EXPECT_NEAR(found.deflection_m[0][16], 0.0, 2e-15);
}

TEST(RungeKutta, MeetsTheModesOfTwoMasses) {
  // Two masses to the ground and to each other: frequencies sqrt(k) and sqrt(k + 2 kc).
  const Element outer{.k = 4};
  const Element coupling{.k = 6};
  const Chain chain{
      .mass_kg = {1, 1},
      .links = {{Link::kGround, 0, outer}, {0, 1, coupling}, {Link::kGround, 1, outer}}};
  const Trajectory found =
      simulate(chain, {{1, 0}, {}}, {.step_s = 0.05, .samples = 400, .substeps = 8});
  for (std::size_t n = 0; n < 400; ++n) {
    const Real t = static_cast<Real>(0.05) * static_cast<Real>(n);
    ASSERT_NEAR(found.deflection_m[0][n], double((std::cos(2 * t) + std::cos(4 * t)) / 2), 3e-16);
    ASSERT_NEAR(found.deflection_m[1][n], double((std::cos(2 * t) - std::cos(4 * t)) / 2), 3e-16);
  }
}

TEST(RungeKutta, ChangesTheStiffnessAtItsTime) {
  Chain chain = single({.k = 4});
  const auto step_s = static_cast<double>(std::numbers::pi_v<Real> / 64);
  chain.change_time_s = 128 * static_cast<Real>(step_s);
  chain.stiffness_factor = 0.25L;
  const Trajectory found =
      simulate(chain, {{1}, {0}}, {.step_s = step_s, .samples = 257, .substeps = 8});
  EXPECT_NEAR(found.deflection_m[0][64], 1.0, 1e-15);
  EXPECT_NEAR(found.deflection_m[0][128], 1.0, 1e-15);
  EXPECT_NEAR(found.deflection_m[0][192], -1.0, 1e-15);
  EXPECT_NEAR(found.deflection_m[0][256], 1.0, 1e-14);
}

TEST(Input, SweepsItsPhase) {
  const Input input{{2, 0.5L, 0.25L}};
  EXPECT_NEAR(static_cast<double>(force_n(input, 3)), 2.0 * std::sin(1.5 + 0.125 * 9.0), 1e-15);
}

}  // namespace
}  // namespace dampline::sim::reference

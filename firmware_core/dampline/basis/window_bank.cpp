// SPDX-License-Identifier: MIT
#include "dampline/basis/window_bank.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

constexpr double kStridesPerHalf = 4.0;  // closer rows bring nothing

/// Derivatives 2, 3 and 4 of (1 - u^2)^8 at u = n / reach, zero beyond the ends, in the factored
/// form that keeps its digits there.
struct Bump {
  double second, third, fourth;
};
Bump bump(int n, int reach) noexcept {
  if (n <= -reach || n >= reach) return {0.0, 0.0, 0.0};
  const double u = static_cast<double>(n) / reach;
  const double q = 1.0 - u * u;
  const double u2 = u * u;
  const double q4 = q * q * q * q;
  return {.second = 16.0 * q4 * q * q * (15.0 * u2 - 1.0),
          .third = 672.0 * u * q4 * q * (1.0 - 5.0 * u2),
          .fourth = 672.0 * q4 * (1.0 - 26.0 * u2 + 65.0 * u2 * u2)};
}

/// 1 / sqrt(sum psi^2), tau left out.
double norm_of(int half) noexcept {
  double energy = 0.0;
  for (int n = -half; n <= half; ++n) {
    const double psi = bump(n, half + 1).fourth;
    energy += psi * psi;
  }
  return 1.0 / std::sqrt(energy);
}

double lump(double left, double centre, double right) noexcept {
  return (left + 10.0 * centre + right) / 12.0;
}

}  // namespace

template <class Number, int kMostHz>
BasicWindowBank<Number, kMostHz>::BasicWindowBank(double sample_rate_hz) noexcept {
  std::size_t start = 0;
  double half = kHalfSupportS * sample_rate_hz;
  for (Window& window : windows_) {
    window.half = std::min(static_cast<int>(std::lround(half)), kMaxHalf);
    window.stride = std::max(1, static_cast<int>(half / kStridesPerHalf));
    window.start = start;
    fill(window, 1.0 / sample_rate_hz);
    start += static_cast<std::size_t>(2 * window.half + 3);
    half /= 2.0;
  }
}

template <class Number, int kMostHz>
void BasicWindowBank<Number, kMostHz>::fill(Window& window, double step_s) noexcept {
  const int reach = window.half + 1;
  const double tau_s = reach * step_s;
  const double norm = norm_of(window.half);
  for (int n = -reach; n <= reach; ++n) {
    const auto i = window.start + static_cast<std::size_t>(n + reach);
    const Bump l = bump(n - 1, reach);
    const Bump c = bump(n, reach);
    const Bump r = bump(n + 1, reach);
    const double psi = norm * c.fourth;
    window.mass += std::abs(psi);
    if constexpr (kHasPsi) psi_[i] = psi;
    if (-window.half <= n && n <= 0)
      half_psi_[window.start / 2 + static_cast<std::size_t>(n + window.half)] =
          static_cast<float>(psi);
    const auto number = [](double x) { return static_cast<Number>(x); };
    lumped_psi_[i] = number(norm * lump(l.fourth, c.fourth, r.fourth));
    lumped_psi1_[i] = number(norm * tau_s * lump(l.third, c.third, r.third));
    lumped_double_integral_[i] = number(norm * tau_s * tau_s * lump(l.second, c.second, r.second));
  }
}

template class BasicWindowBank<double, 400>;
template class BasicWindowBank<float, 300>;

}  // namespace dampline

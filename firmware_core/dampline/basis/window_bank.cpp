// SPDX-License-Identifier: MIT
#include "dampline/basis/window_bank.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

constexpr double kHalfSupportS = 208.0 / 300.0;  // of the 2 Hz scale
constexpr double kStridesPerHalf = 4.0;          // closer rows bring nothing

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

WindowBank::WindowBank(double sample_rate_hz) noexcept {
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

void WindowBank::fill(Window& window, double step_s) noexcept {
  const int reach = window.half + 1;
  const double tau_s = reach * step_s;
  const double norm = norm_of(window.half);
  for (int n = -reach; n <= reach; ++n) {
    const auto i = window.start + static_cast<std::size_t>(n + reach);
    const Bump l = bump(n - 1, reach);
    const Bump c = bump(n, reach);
    const Bump r = bump(n + 1, reach);
    psi_[i] = norm * c.fourth;
    window.mass += std::abs(psi_[i]);
    lumped_psi_[i] = norm * lump(l.fourth, c.fourth, r.fourth);
    lumped_psi1_[i] = norm * tau_s * lump(l.third, c.third, r.third);
    lumped_double_integral_[i] = norm * tau_s * tau_s * lump(l.second, c.second, r.second);
  }
  const std::span<const double> half =
      std::span{psi_}.subspan(window.start + 1, static_cast<std::size_t>(window.half) + 1);
  for (std::size_t i = 0; i < half.size(); ++i)
    half_psi_[window.start / 2 + i] = static_cast<float>(half[i]);
}

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <numbers>

namespace dampline::app {

/// Blackman's weight, 1 at 0, 0 from +-1 on.
[[nodiscard]] inline double blackman(double u) {
  if (std::abs(u) >= 1.0) return 0.0;
  const double turn = std::numbers::pi * u;
  return 0.42 + 0.5 * std::cos(turn) + 0.08 * std::cos(2.0 * turn);
}

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>

namespace dampline {

/// One point of the extended phase space.
struct PhasePoint {
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double accel_mps2{0.0};
};

/// Stuck points obey an inequality, not the equation of motion, and a single one that noise makes
/// look moving spoils a fit. A velocity above this many standard deviations of its noise moves: one
/// stuck point in 26 million passes.
inline constexpr double kMovingSigmas = 5.5;

[[nodiscard]] inline bool is_finite(const PhasePoint& p) noexcept {
  return std::isfinite(p.deflection_m) && std::isfinite(p.velocity_mps) &&
         std::isfinite(p.accel_mps2);
}

}  // namespace dampline

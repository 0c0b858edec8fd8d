// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>

namespace dampline::sim {

/// Additions to the linear spring k y; zero switches an effect off.
struct StiffnessEffects {
  double cubic_npm3{0.0};          ///< k3 y^3
  double quadratic_npm2{0.0};      ///< k2 y^2
  double asymmetry_npm{0.0};       ///< more stiffness for y > 0 only
  double bump_stiffness_npm{0.0};  ///< contact beyond bump_gap_m
  double bump_gap_m{0.0};          ///< of y, from the static position
  bool bump_one_sided{false};      ///< contact for y > 0 only
};

[[nodiscard]] inline double added_stiffness_n(const StiffnessEffects& effects, double y) noexcept {
  double force = y * y * (effects.quadratic_npm2 + effects.cubic_npm3 * y) +
                 effects.asymmetry_npm * std::max(y, 0.0);
  const double beyond = std::abs(y) - effects.bump_gap_m;
  if (effects.bump_stiffness_npm > 0.0 && beyond > 0.0 && (y > 0.0 || !effects.bump_one_sided)) {
    force += effects.bump_stiffness_npm * std::copysign(beyond, y);
  }
  return force;
}

}  // namespace dampline::sim

// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>

namespace dampline::sim {

/// Additions to the friction force; a zero coefficient or length switches an effect off.
/// v is the rate of the relative deflection y = 2 z_b - (z_1 + z_2).
struct DampingEffects {
  double viscous_positive_nspm{0.0};  ///< c v for v > 0; `viscous` sets both alike
  double viscous_negative_nspm{0.0};  ///< c v for v < 0
  double quadratic_ns2pm2{0.0};       ///< q v |v|
  double offset_n{0.0};               ///< constant force
  double stribeck_share{0.0};         ///< friction times 1 + share exp(-|v| / stribeck_speed)
  double stribeck_speed_mps{0.01};
  double progressive_length_m{0.0};  ///< friction times max(0, 1 + y / length)
  bool progressive_absolute{false};  ///< times 1 + |y| / length instead
};

/// What multiplies the Coulomb level; never negative, so that friction never drives.
[[nodiscard]] inline double friction_factor(const DampingEffects& effects, double y,
                                            double v) noexcept {
  double factor = 1.0;
  if (effects.stribeck_share != 0.0) {
    factor += effects.stribeck_share * std::exp(-std::abs(v) / effects.stribeck_speed_mps);
  }
  if (effects.progressive_length_m > 0.0) {
    const double reach = effects.progressive_absolute ? std::abs(y) : y;
    factor *= 1.0 + reach / effects.progressive_length_m;
  }
  return std::max(factor, 0.0);
}

/// The forces that are added to friction.
[[nodiscard]] inline double added_damping_n(const DampingEffects& effects, double v) noexcept {
  const double viscous = v > 0.0 ? effects.viscous_positive_nspm : effects.viscous_negative_nspm;
  return v * (viscous + effects.quadratic_ns2pm2 * std::abs(v)) + effects.offset_n;
}

}  // namespace dampline::sim

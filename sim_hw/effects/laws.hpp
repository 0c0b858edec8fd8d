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

struct HysteresisEffects {
  /// Dahl: friction = level * zeta, d zeta / dy = (1 - zeta sign v) / distance. 0: off.
  double presliding_distance_m{0.0};
  /// Free play of the friction damper: no friction force until the gap is taken up after each
  /// reversal. The force then rises over the last kBacklashRamp of the gap. 0: off.
  double backlash_gap_m{0.0};
  /// A spring of this stiffness behind a dashpot, beside the suspension (Maxwell). 0: off.
  double viscoelastic_npm{0.0};
  double viscoelastic_s{0.02};  ///< dashpot over spring
};
inline constexpr double kBacklashRamp = 0.02;

/// d zeta / dt of Dahl's law.
[[nodiscard]] inline double dahl_rate_ps(double distance_m, double zeta, double v) noexcept {
  return (v - zeta * std::abs(v)) / distance_m;
}

/// d x / dt of the stretch x of a spring behind a dashpot.
[[nodiscard]] inline double stretch_rate_mps(double time_s, double stretch_m, double v) noexcept {
  return v - stretch_m / time_s;
}

/// The piston inside its play: it is dragged along only by the ends of the gap.
class Play {
 public:
  void follow(double gap_m, double y) noexcept {
    piston_m_ = std::clamp(piston_m_, y - 0.5 * gap_m, y + 0.5 * gap_m);
  }
  /// Share of the force that gets through at deflection y moving with sign(v): 0 in the gap, 1 at
  /// the end towards which y moves.
  [[nodiscard]] double engagement(double gap_m, double y, double v) const noexcept {
    const double travelled = std::copysign(1.0, v) * (y - piston_m_) + 0.5 * gap_m;
    const double ramp = kBacklashRamp * gap_m;
    return std::clamp((travelled - gap_m + ramp) / ramp, 0.0, 1.0);
  }

 private:
  double piston_m_{0.0};
};

/// Degrees of freedom that the one-mass model lacks.
struct ModeEffects {
  /// Pitch of the frame: spring and friction act per wheelset, on 2 y_1 and 2 y_2 with
  /// y_1 = z_b + a theta - z_1, y_2 = z_b - a theta - z_2. 0: off.
  double pitch_inertia_kgm2{0.0};
  double pitch_half_wheelbase_m{0.9};
  /// A share of the moving mass on a spring and damper: the body bends. 0: off.
  double flexible_share{0.0};
  double flexible_frequency_hz{9.0};
  double flexible_damping_ratio{0.03};
};

/// Parameters that change over the record: factors that are reached at end_s, linearly from 1 at
/// start_s; a step where end_s <= start_s.
struct DriftEffects {
  double friction_factor{1.0};
  double stiffness_factor{1.0};
  double mass_factor{1.0};
  double start_s{0.0};
  double end_s{0.0};
  [[nodiscard]] bool active() const noexcept {
    return friction_factor != 1.0 || stiffness_factor != 1.0 || mass_factor != 1.0;
  }
};

/// 0 before start_s, 1 from end_s on.
[[nodiscard]] inline double drift_progress(const DriftEffects& effects, double time_s) noexcept {
  if (time_s < effects.start_s) return 0.0;
  const double length = effects.end_s - effects.start_s;
  return length > 0.0 ? std::min((time_s - effects.start_s) / length, 1.0) : 1.0;
}

}  // namespace dampline::sim

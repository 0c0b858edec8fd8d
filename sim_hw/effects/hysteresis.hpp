// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>

namespace dampline::sim {

struct HysteresisEffects {
  /// Dahl: friction = level * zeta, d zeta / dy = (1 - zeta sign v) / distance. 0: off.
  double presliding_distance_m{0.0};
  /// Free play of the friction damper: no friction force until the gap is taken up after each
  /// reversal. The force then rises over the last kBacklashRamp of the gap. 0: off.
  double backlash_gap_m{0.0};
};
inline constexpr double kBacklashRamp = 0.02;

/// d zeta / dt of Dahl's law.
[[nodiscard]] inline double dahl_rate_ps(double distance_m, double zeta, double v) noexcept {
  return (v - zeta * std::abs(v)) / distance_m;
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

}  // namespace dampline::sim

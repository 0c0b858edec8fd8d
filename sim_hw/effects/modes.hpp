// SPDX-License-Identifier: MIT
#pragma once

namespace dampline::sim {

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

}  // namespace dampline::sim

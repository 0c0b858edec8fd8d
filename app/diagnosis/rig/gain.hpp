// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/diagnosis/rig/explanation.hpp"

namespace dampline::app::rig {

/// What a velocity or an acceleration that was measured beside the deflection is, over what the
/// deflection's differences say. Over the same stretch 2 T, with no derivative of what is noisy:
///   x(t + T) - x(t - T) = integral of x' over the stretch,
///   x(t + T) - 2 x(t) + x(t - T) = integral of (T - |s|) x''(t + s).
/// T is an eighth of the motion's period. A constant is free, the deflection's noise is taken off.
struct Gain {
  bool known{false};
  double gain{1.0};
  double std{0.0};          ///< by the jackknife over blocks
  double related{0.0};      ///< squared correlation
  double nmse_before{0.0};  ///< of the integral, with a gain of 1
  double nmse_after{0.0};
};
struct Gains {
  Gain velocity;
  Gain accel;
};

/// Throws RunError where the rate that was measured cannot be that of the deflection: another unit,
/// another sign, or no relation at all.
[[nodiscard]] Gains checked_gains(const Series& series);
/// gain_error as a step where either gain of a record is not 1; a note where none can be seen.
/// `gains` in the order of `out.records`.
void judge_gains(const std::vector<Gains>& gains, Explanation& out);

}  // namespace dampline::app::rig

// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>

namespace dampline::sim {

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

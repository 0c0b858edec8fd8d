// SPDX-License-Identifier: MIT
#pragma once
#include <optional>

#include "app/diagnosis/rig/rig_trials.hpp"

namespace dampline::app {

/// The state of Bouc and Wen's hysteresis in metres, dz = dx - (|dx| z + b dx |z|) / a: over the
/// travel a it forgets where it turned; b = 0 is Dahl's, b below -1 one that never slips. Slipping
/// at the start where it moves, 0 where it rests. Wen 1976, exponent 1.
[[nodiscard]] Eigen::VectorXd bouc_wen(const Eigen::VectorXd& deflection_m, double travel_m,
                                       double shape);

/// Where it slips, in metres: the largest state; 0 where it never comes to slip.
[[nodiscard]] double bouc_wen_slip_m(double travel_m, double shape);

struct BoucWen {
  RigColumn column;
  RigFit fit;
  double travel_std_m{0.0};
  double shape_std{0.0};
};

/// The one that leaves least beside a base; nothing where none helps.
[[nodiscard]] std::optional<BoucWen> best_bouc_wen(const std::vector<RigSeries>& records,
                                                   const RigTrialBase& base, double deflection_m);

}  // namespace dampline::app

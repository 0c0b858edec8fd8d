// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/diagnosis/rig/rig_explanation.hpp"

namespace dampline::app {

/// The force of a model at the rows that were made for it.
[[nodiscard]] Eigen::VectorXd model_force(const RigModel& model, const RigRows& rows);

/// A record with what the model says of its instants and of the force's path.
[[nodiscard]] RigSeries seen_by(const RigModel& model, const RigSeries& series);

/// What the report shows of an explanation, and what is left: fills `evidence` but for its JSON,
/// and `signature`.
void gather_evidence(const std::vector<RigSeries>& records, RigExplanation& explanation);

}  // namespace dampline::app

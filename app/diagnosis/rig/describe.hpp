// SPDX-License-Identifier: MIT
#pragma once
#include "app/diagnosis/rig/joint.hpp"
#include "app/diagnosis/rig/state.hpp"

namespace dampline::app::rig {

/// Writes a model's parameters with their deviations, and those of its steps; `of`: the columns of
/// each step in the model. Figures that cancel one another are listed, and noted; a deviation that
/// the halves of the record contradict is widened, and that is noted.
void describe(const State& s, const Joint& joint, Model& model, std::vector<Chosen>& steps,
              const ColumnSet& columns, std::vector<std::string>& notes);

}  // namespace dampline::app::rig

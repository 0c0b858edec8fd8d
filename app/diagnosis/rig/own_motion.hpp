// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/diagnosis/rig/joint.hpp"

namespace dampline::app::rig {

/// The law of whose motion the equations say what they say of the records (indirect inference;
/// Gourieroux, Monfort and Renault, 1993): friction's leaps, seen through a test function, bend
/// them. A part of what was taken off stays in the deviation.
void correct_by_own_motion(const std::vector<Series>& records, const Scale& scale, Model& model,
                           Joint& joint);

}  // namespace dampline::app::rig

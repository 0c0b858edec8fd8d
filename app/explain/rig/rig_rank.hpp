// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <string>

#include "app/explain/rig/rig_evidence.hpp"

namespace dampline::app {

/// How sure it is that `after` predicts better: mean over deviation of the mean of the blocks'
/// improvements.
[[nodiscard]] double block_t(const RigFit& before, const RigFit& after);

[[nodiscard]] inline ColumnSet joined(ColumnSet a, const ColumnSet& b) {
  for (const Eigen::Index i : b)
    if (std::find(a.begin(), a.end(), i) == a.end()) a.push_back(i);
  return a;
}

[[nodiscard]] inline bool is_memory(const std::string& effect) {
  return effect == "backlash" || effect == "presliding_hysteresis";
}

}  // namespace dampline::app

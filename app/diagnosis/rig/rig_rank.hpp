// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "app/diagnosis/rig/rig_evidence.hpp"

namespace dampline::app {

/// How sure it is that `after` predicts better: mean over deviation of the mean of the blocks'
/// improvements.
[[nodiscard]] double block_t(const RigFit& before, const RigFit& after);

/// Standard deviation of a figure, from what it is with each part of the data left out in turn.
[[nodiscard]] double jackknife_std(const std::vector<double>& left_out);

[[nodiscard]] inline ColumnSet joined(ColumnSet a, const ColumnSet& b) {
  for (const Eigen::Index i : b)
    if (std::find(a.begin(), a.end(), i) == a.end()) a.push_back(i);
  return a;
}

/// Where a column of the set stands in theta.
[[nodiscard]] inline Eigen::Index place_of(const ColumnSet& set, Eigen::Index column) {
  return std::find(set.begin(), set.end(), column) - set.begin();
}

[[nodiscard]] inline bool is_memory(const std::string& effect) {
  return effect == "backlash" || effect == "presliding_hysteresis";
}

}  // namespace dampline::app

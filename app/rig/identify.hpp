// SPDX-License-Identifier: MIT
#pragma once
#include <functional>

#include "app/config/config.hpp"
#include "app/rig/record.hpp"
#include "app/run/result.hpp"

namespace dampline::app::rig {

/// Called now and then with the share of the work that is done, 0...1.
using Progress = std::function<void(double)>;

/// Identifies what a rig's measured force consists of. Reads the record three times (rate and
/// noise; the equations; convergence and prediction), so memory does not grow with it.
///
/// A plain "coulomb" is one level; where no offset_force stands beside it and a level per direction
/// lowers the held-out error by more than 1 %, both are reported (_positive, _negative).
///
/// Throws UsageError for a model that a rig cannot have, RunError naming the record, what was found
/// and what was expected: too few rows, time that does not advance or is not uniform, no motion,
/// too little of it to determine the parameters.
[[nodiscard]] RunResult identify(const Record& record, const Config& config,
                                 const Progress& progress = {});

}  // namespace dampline::app::rig

// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/diagnosis/rig/rig_explanation.hpp"

namespace dampline::app {

struct RigExplainOptions {
  std::vector<std::string> records;
  std::vector<std::string> validation;
  std::string reference_column;  ///< of the validation records; empty: none
  bool skip_bad_lines{false};
};

/// Explains records of a rig that measures motion and force, all with one model. Keeps the records
/// in memory. Throws RunError or UsageError.
[[nodiscard]] RigExplanation explain_rig(const Config& config, const RigExplainOptions& options);

}  // namespace dampline::app

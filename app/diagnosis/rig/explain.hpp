// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/diagnosis/rig/explanation.hpp"

namespace dampline::app::rig {

struct ExplainOptions {
  std::vector<std::string> records;
  std::vector<std::string> validation;
  std::string reference_column;  ///< of the validation records; empty: none
  bool skip_bad_lines{false};
  bool refine{true};  ///< the law of a driven mass by its own motion
};

/// Explains records of a rig that measures motion and force, all with one model. Keeps the records
/// in memory. Throws RunError or UsageError.
[[nodiscard]] Explanation explain(const Config& config, const ExplainOptions& options);

}  // namespace dampline::app::rig

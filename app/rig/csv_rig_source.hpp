// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/config/config.hpp"
#include "app/rig/rig_source.hpp"

namespace dampline::app {

/// A rig's record in a CSV file, its columns and scales as [input.columns] and [input.scale] say.
/// Opening throws RunError naming the file and the column that is missing; reading, file and line.
/// Standard input cannot be read several times: RunError.
[[nodiscard]] RigRecord csv_rig_record(const std::string& path, const InputConfig& input,
                                       bool skip_bad_lines);

}  // namespace dampline::app

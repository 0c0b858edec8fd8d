// SPDX-License-Identifier: MIT
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/run/checksum.hpp"
#include "app/run/directory.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// What a run directory is made of beside report.html.
struct RunFiles {
  RunResult result;
  std::string run_toml;
  std::string state;  ///< state.dls; empty: there is none
};

/// Stages everything. Throws RunError.
void stage_files(const RunFiles& files, RunDirectory& directory);

/// Reads a run back for its report; the state stays where it is. Throws RunError naming the file
/// that is missing or damaged.
[[nodiscard]] RunFiles read_files(const std::filesystem::path& run);

}  // namespace dampline::app

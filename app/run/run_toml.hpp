// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/run/checksum.hpp"

namespace dampline::app {

/// The program's version, "0.1.0".
[[nodiscard]] std::string version();

/// The complete configuration, and in the table [run] what went in. Loads back as a configuration.
[[nodiscard]] std::string write_run_toml(const Config& config,
                                         const std::vector<InputFile>& inputs);

/// What a run.toml says about the run itself.
struct Provenance {
  std::string version;
  std::vector<InputFile> inputs;
};

/// Throws RunError naming `origin` when [run] is missing or is not what write_run_toml() writes.
[[nodiscard]] Provenance read_provenance(std::string_view text, const std::string& origin);

}  // namespace dampline::app

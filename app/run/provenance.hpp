// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/config/config.hpp"

namespace dampline::app {

/// A file that went into a run.
struct InputFile {
  std::string name;  ///< as given; "-" is standard input, which has no size and no checksum
  std::string role;  ///< "record" or "dbc"
  std::uint64_t bytes{0};
  std::string sha256;  ///< 64 hexadecimal digits, as sha256sum prints them; empty: not known
};

/// Reads the file through once. Throws RunError when it cannot be read.
[[nodiscard]] InputFile describe_input(const std::filesystem::path& file, const std::string& role);

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

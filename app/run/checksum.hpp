// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

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

}  // namespace dampline::app

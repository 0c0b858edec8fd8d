// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace dampline::proof {

/// A file of the project, read whole; `path` is relative to the top of the source tree.
struct SourceFile {
  std::string path;
  std::string text;
};

/// Every .hpp and .cpp file below `rooms` (folders of the source tree), ordered by path.
[[nodiscard]] std::vector<SourceFile> read_sources(const std::vector<std::string>& rooms);

/// What the file's #include lines name, without quotes and angle brackets.
[[nodiscard]] std::vector<std::string> includes(std::string_view text);

[[nodiscard]] std::size_t count_lines(std::string_view text);

}  // namespace dampline::proof

// SPDX-License-Identifier: MIT
#include "tests/proof/source_tree.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

namespace dampline::proof {
namespace fs = std::filesystem;
namespace {

/// What stands between quotes or angle brackets where the line is an #include.
std::optional<std::string> included_name(std::string_view line) {
  const auto skip = [&line](std::string_view what) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    const bool found = line.starts_with(what);
    if (found) line.remove_prefix(what.size());
    return found;
  };
  if (!skip("#") || !skip("include")) return std::nullopt;
  const char closing = skip("<") ? '>' : '"';
  if (closing == '"' && !skip("\"")) return std::nullopt;
  return std::string{line.substr(0, line.find(closing))};
}

}  // namespace

std::vector<SourceFile> read_sources(const std::vector<std::string>& rooms) {
  const fs::path top{DAMPLINE_SOURCE_DIR};
  std::vector<SourceFile> files;
  for (const std::string& room : rooms) {
    for (const auto& entry : fs::recursive_directory_iterator{top / room}) {
      const fs::path& path = entry.path();
      if (path.extension() != ".hpp" && path.extension() != ".cpp") continue;
      std::ifstream stream{path};
      files.push_back({fs::relative(path, top).generic_string(),
                       std::string{std::istreambuf_iterator<char>{stream}, {}}});
    }
  }
  std::sort(files.begin(), files.end(),
            [](const SourceFile& a, const SourceFile& b) { return a.path < b.path; });
  return files;
}

std::vector<std::string> includes(std::string_view text) {
  std::vector<std::string> names;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1);
    if (const auto name = included_name(text.substr(0, end + 1))) names.push_back(*name);
    text.remove_prefix(end + 1);
  }
  return names;
}

std::size_t count_lines(std::string_view text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace dampline::proof

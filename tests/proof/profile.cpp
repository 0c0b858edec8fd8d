// SPDX-License-Identifier: MIT
#include "tests/proof/profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "tests/proof/command.hpp"

namespace dampline::proof {
namespace {

/// "(7) name" names function 7, "(7)" means it again.
class Names {
 public:
  const std::string& resolve(const std::string& text) {
    const auto end = text.find(')');
    std::string& name = names_[text.substr(0, end)];
    if (end != std::string::npos && end + 2 < text.size()) name = text.substr(end + 2);
    return name;
  }

 private:
  std::map<std::string, std::string> names_;
};

Profile profile_with(const std::string& option, const std::string& command,
                     const std::string& path) {
  const CommandResult run =
      run_command("valgrind --quiet --tool=callgrind --dump-line=no " + option +
                  " --callgrind-out-file='" + path + "' " + command + " 2>&1");
  if (run.status != 0) throw std::runtime_error{"valgrind: " + run.output};
  std::ifstream file{path};
  return parse_callgrind({std::istreambuf_iterator<char>{file}, {}});
}

}  // namespace

std::uint64_t total_of(const Profile& profile) noexcept {
  std::uint64_t total = 0;
  for (const auto& [name, count] : profile) total += count;
  return total;
}

Profile parse_callgrind(const std::string& text) {
  Profile out;
  Names names;
  std::string current;
  bool is_call = false;  // the next line holds what the called function cost
  std::istringstream lines{text};
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("fn=")) {
      current = names.resolve(line.substr(3));
    } else if (line.starts_with("cfn=")) {
      static_cast<void>(names.resolve(line.substr(4)));
    } else if (line.starts_with("calls=")) {
      is_call = true;
    } else if (!current.empty() && !line.empty() &&
               line.find_first_not_of("0123456789+-* ") == std::string::npos) {
      std::istringstream words{line};
      std::string position;
      std::uint64_t count = 0;
      if (words >> position >> count && !is_call) out[current] += count;
      is_call = false;
    }
  }
  return out;
}

Profile profile_inside(const std::string& command, const std::string& function,
                       const std::string& path) {
  return profile_with("--toggle-collect='" + function + "'", command, path);
}

Profile profile_of(const std::string& command, const std::string& path) {
  return profile_with("", command, path);
}

std::string describe_growth(const Profile& before, const Profile& now, std::size_t lines) {
  std::map<std::string, std::int64_t> growth;
  for (const auto& [name, count] : now) growth[name] += static_cast<std::int64_t>(count);
  for (const auto& [name, count] : before) growth[name] -= static_cast<std::int64_t>(count);
  std::vector<std::pair<std::string, std::int64_t>> sorted{growth.begin(), growth.end()};
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  for (std::size_t i = 0; i < std::min(lines, sorted.size()); ++i)
    text += fmt::format("  {:+12} {}\n", sorted[i].second, sorted[i].first);
  return text;
}

}  // namespace dampline::proof

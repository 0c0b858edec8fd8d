// SPDX-License-Identifier: MIT
#include "tests/proof/callgrind.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/proof/command.hpp"

namespace dampline::proof {
namespace fs = std::filesystem;
namespace {

/// The number after "totals:" in a file of callgrind's.
std::uint64_t total(const fs::path& path) {
  std::ifstream file{path};
  for (std::string word; file >> word;) {
    std::uint64_t count = 0;
    if (word == "totals:" && file >> count) return count;
  }
  throw std::runtime_error{path.string() + " holds no totals"};
}

}  // namespace

std::vector<std::uint64_t> instructions_per_call(const std::string& command,
                                                 const std::string& function,
                                                 const std::string& folder) {
  fs::remove_all(folder);
  fs::create_directories(folder);
  const fs::path prefix = fs::path{folder} / "calls";
  const CommandResult run = run_command(
      "valgrind --quiet --tool=callgrind --toggle-collect='" + function + "' --dump-after='" +
      function + "' --callgrind-out-file='" + prefix.string() + "' " + command + " 2>&1");
  if (run.status != 0) throw std::runtime_error{"valgrind: " + run.output};
  std::vector<std::uint64_t> counts;
  for (;;) {  // one numbered file a call, from 1
    const fs::path dump = prefix.string() + "." + std::to_string(counts.size() + 1);
    if (!fs::exists(dump)) break;
    counts.push_back(total(dump));
  }
  return counts;
}

}  // namespace dampline::proof

// SPDX-License-Identifier: MIT
#include "tests/proof/counts.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <utility>
#include <vector>

namespace dampline::proof {
namespace fs = std::filesystem;
namespace {

constexpr double kMostGrowth = 1.03;
constexpr double kMostShrinkage = 0.90;

fs::path counts_folder() {
  return fs::path{DAMPLINE_SOURCE_DIR} / fmt::format("tests/proof/counts/gcc-{}", __GNUC__);
}

bool writes() { return std::getenv("DAMPLINE_WRITE_COUNTS") != nullptr; }

bool has_wide_vectors() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

/// One function a line: instructions, name.
Profile read_counts(const fs::path& path) {
  Profile out;
  std::ifstream file{path};
  for (std::string line; std::getline(file, line);) {
    const auto space = line.find(' ');
    if (space != std::string::npos)
      out[line.substr(space + 1)] = std::strtoull(line.c_str(), nullptr, 10);
  }
  return out;
}

/// The largest first; what is below a thousandth goes together.
void write_counts(const fs::path& path, const Profile& profile) {
  std::vector<std::pair<std::uint64_t, std::string>> lines;
  std::uint64_t rest = 0;
  for (const auto& [name, count] : profile) {
    if (count * 1000 > total_of(profile))
      lines.emplace_back(count, name);
    else
      rest += count;
  }
  std::stable_sort(lines.rbegin(), lines.rend());
  if (rest > 0) lines.emplace_back(rest, "(all others)");
  fs::create_directories(path.parent_path());
  std::ofstream file{path};
  for (const auto& [count, name] : lines) file << count << ' ' << name << '\n';
}

}  // namespace

std::optional<std::string> why_not_counted() {
  if (!fs::exists("/proc/self/maps")) return "valgrind needs /proc";
  if (!has_wide_vectors()) return "the counts are those of a processor with AVX2";
  if (!writes() && !fs::exists(counts_folder())) return "no counts are committed for this compiler";
  return std::nullopt;
}

void check_counts(const std::string& name, const Profile& now, std::int64_t samples) {
  const fs::path path = counts_folder() / (name + ".txt");
  if (writes()) write_counts(path, now);
  const Profile before = read_counts(path);
  ASSERT_FALSE(before.empty()) << "no counts in " << path;
  const double ratio = static_cast<double>(total_of(now)) / static_cast<double>(total_of(before));
  fmt::print("{}: {:.1f} instructions per sample, {:+.2f} % of what is committed\n", name,
             static_cast<double>(total_of(now)) / static_cast<double>(samples),
             100.0 * (ratio - 1.0));
  EXPECT_LE(ratio, kMostGrowth) << "what grew, in instructions:\n"
                                << describe_growth(before, now, 12);
  EXPECT_GE(ratio, kMostShrinkage) << "a gain: commit the new counts, so that it cannot be lost";
}

}  // namespace dampline::proof

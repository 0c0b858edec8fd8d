// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace dampline::proof {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

const fs::path kTop{DAMPLINE_SOURCE_DIR};

bool is_source(std::string_view word) { return word.ends_with(".hpp") || word.ends_with(".cpp"); }

/// Words that name a file or folder of the repository: below one of its top folders, or a source.
std::vector<std::string> paths_in(std::string_view text) {
  constexpr std::array<std::string_view, 7> kFolders{
      "app/", "bench/", "drivers/", "firmware_core/", "hal/", "sim_hw/", "tests/"};
  const std::string_view of_path =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./";
  std::vector<std::string> out;
  for (std::size_t at = text.find_first_of(of_path); at < text.size();
       at = text.find_first_of(of_path, at)) {
    const std::size_t end = std::min(text.find_first_not_of(of_path, at), text.size());
    std::string_view word = text.substr(at, end - at);
    at = end;
    if (word.starts_with("./")) word.remove_prefix(2);
    while (!word.empty() && word.back() == '.') word.remove_suffix(1);
    const bool below = std::any_of(kFolders.begin(), kFolders.end(),
                                   [&](std::string_view f) { return word.starts_with(f); });
    if (below || (is_source(word) && word.find('/') != std::string_view::npos))
      out.emplace_back(word);
  }
  return out;
}

/// What documents leave out: the core's folders, the ending of a source.
bool exists(const std::string& path) {
  const fs::path core = kTop / "firmware_core";
  const std::array<fs::path, 5> places{kTop / path, kTop / (path + ".cpp"), kTop / (path + ".hpp"),
                                       core / path, core / "dampline" / path};
  return std::any_of(places.begin(), places.end(), [](const fs::path& p) { return fs::exists(p); });
}

std::vector<fs::path> documents() {
  std::vector<fs::path> out{kTop / "README.md"};
  for (const char* folder : {"firmware_core/docs", "app/docs"}) {
    if (!fs::exists(kTop / folder)) continue;
    for (const auto& entry : fs::directory_iterator{kTop / folder})
      if (entry.path().extension() == ".md") out.push_back(entry.path());
  }
  return out;
}

TEST(Documents, NameFilesThatExist) {
  for (const fs::path& document : documents()) {
    std::ifstream stream{document};
    const std::string text{std::istreambuf_iterator<char>{stream}, {}};
    std::vector<std::string> gone;
    for (const std::string& path : paths_in(text))
      if (!exists(path)) gone.push_back(path);
    EXPECT_THAT(gone, IsEmpty()) << document;
  }
}

TEST(Documents, NameFilesByTheirPaths) {
  EXPECT_THAT(
      paths_in("`bench/guards 3`, (app/docs/guide.md), build/release/bench/x, and/or.\n"
               "./tests/run, motion/fir.hpp, fir.hpp, bench/run."),
      ElementsAre("bench/guards", "app/docs/guide.md", "tests/run", "motion/fir.hpp", "bench/run"));
}

}  // namespace
}  // namespace dampline::proof

// SPDX-License-Identifier: MIT
// What the fuzzers found, and where they begin, through every reader: holds without clang.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/fuzz/readers.hpp"

namespace dampline::fuzz {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> bytes_of(const fs::path& file) {
  std::ifstream stream{file, std::ios::binary};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

class Corpus : public testing::TestWithParam<Reader> {};

TEST_P(Corpus, IsReadWithoutAFault) {
  const fs::path folder = fs::path{DAMPLINE_SOURCE_DIR} / "tests/fuzz/corpus" / GetParam().name;
  std::size_t files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator{folder}) {
    const std::vector<std::uint8_t> bytes = bytes_of(entry.path());
    SCOPED_TRACE(entry.path());
    GetParam().read(bytes);
    ++files;
  }
  EXPECT_GT(files, 0U);
}

/// Every prefix, and every byte changed: quick for what a few KB hold.
TEST_P(Corpus, IsReadCutOffAndChanged) {
  const fs::path folder = fs::path{DAMPLINE_SOURCE_DIR} / "tests/fuzz/corpus" / GetParam().name;
  for (const fs::directory_entry& entry : fs::directory_iterator{folder}) {
    std::vector<std::uint8_t> bytes = bytes_of(entry.path());
    const std::size_t step = bytes.size() / 200 + 1;
    for (std::size_t at = 0; at < bytes.size(); at += step) {
      GetParam().read(Bytes{bytes}.first(at));
      const std::uint8_t before = bytes[at];
      for (const int other : {0x00, 0xff, before ^ 0x20, before ^ 0x01}) {
        bytes[at] = static_cast<std::uint8_t>(other);
        GetParam().read(bytes);
      }
      bytes[at] = before;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, Corpus, testing::ValuesIn(readers().begin(), readers().end()),
                         [](const auto& reader) { return std::string{reader.param.name}; });

}  // namespace
}  // namespace dampline::fuzz

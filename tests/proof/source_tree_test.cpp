// SPDX-License-Identifier: MIT
#include "tests/proof/source_tree.hpp"

#include <gtest/gtest.h>

namespace dampline::proof {
namespace {

TEST(SourceTree, HasNoFileOfMoreThan500Lines) {
  for (const SourceFile& file :
       read_sources({"firmware_core", "hal", "drivers", "sim_hw", "app", "tests", "bench"})) {
    EXPECT_LE(count_lines(file.text), 500U) << file.path;
  }
}

TEST(SourceTree, ShowsWhatAFileIncludes) {
  EXPECT_EQ(
      includes("#include <span>\n // #include <no>\n\t# include \"a/b.hpp\"  // <x>\nint i;\n"),
      (std::vector<std::string>{"span", "a/b.hpp"}));
  EXPECT_TRUE(includes("#define X\n#include X").empty());
}

TEST(SourceTree, CountsTheLinesOfAFile) { EXPECT_EQ(count_lines("a\nb\n\n"), 3U); }

TEST(SourceTree, StatesItsLicenceInEveryFile) {
  for (const SourceFile& file :
       read_sources({"firmware_core", "hal", "drivers", "sim_hw", "app", "tests", "bench"})) {
    EXPECT_TRUE(file.text.starts_with("// SPDX-License-Identifier: MIT\n")) << file.path;
  }
}

TEST(Core, SizesEveryMatrixAtCompileTime) {
  for (const SourceFile& file : read_sources({"firmware_core"})) {
    for (const char* dynamic : {"Eigen::Dynamic", "MatrixX", "VectorX", "ArrayX"}) {
      EXPECT_EQ(file.text.find(dynamic), std::string::npos) << file.path << " uses " << dynamic;
    }
  }
}

// C's library for a Cortex-M7 has none of them in standard C++.
TEST(Core, TakesNoConstantsFromMacrosOfPosix) {
  for (const SourceFile& file : read_sources({"firmware_core"}))
    EXPECT_EQ(file.text.find("M_PI"), std::string::npos) << file.path;
}

}  // namespace
}  // namespace dampline::proof

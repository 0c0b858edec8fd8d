// SPDX-License-Identifier: MIT
#include "tests/proof/constants.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>

namespace dampline::proof {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Of the rooms that judge.
std::vector<SourceFile> judging_sources() {
  std::vector<SourceFile> files = read_sources({"firmware_core", "app"});
  const auto is_elsewhere = [](const SourceFile& file) {
    for (const char* room :
         {"firmware_core/dampline/guard/", "firmware_core/dampline/effect/",
          "firmware_core/dampline/sample/", "firmware_core/dampline/phase/",
          "firmware_core/published/phase/", "firmware_core/dampline/motion/frame_noise",
          "firmware_core/dampline/motion/fractional_delay", "app/diagnosis/", "app/law/",
          "app/identify/low_pass", "app/run/trust"})
      if (file.path.starts_with(room)) return false;
    return true;
  };
  std::erase_if(files, is_elsewhere);
  return files;
}

std::vector<std::string> texts(const std::vector<Constant>& constants) {
  std::vector<std::string> out;
  for (const Constant& c : constants) out.push_back(c.text());
  return out;
}

std::string constants_markdown() {
  std::ifstream stream{std::filesystem::path{DAMPLINE_SOURCE_DIR} /
                       "firmware_core/docs/constants.md"};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

/// A new threshold needs a row with what it decides and where its value comes from; a row whose
/// constant is gone, or has another value, goes or says the new one.
TEST(Constants, StandInTheTableWithTheirValues) {
  const std::vector<Constant> table = constants_in_table(constants_markdown());
  const std::vector<Constant> sources = constants_of(judging_sources());
  ASSERT_GT(sources.size(), 100U);
  EXPECT_THAT(missing_from(table, sources), IsEmpty()) << "not in constants.md";
  EXPECT_THAT(missing_from(sources, table), IsEmpty()) << "no such constant";
}

/// The head says how many have an origin of each kind.
TEST(Constants, AreCountedByTheirOrigin) {
  const std::string markdown = constants_markdown();
  std::map<std::string, std::size_t> stated, counted;
  const std::regex head{R"(\n\| ([a-d]) \| .* \| (\d+) \|)"};
  for (std::sregex_iterator row{markdown.begin(), markdown.end(), head}, end; row != end; ++row)
    stated[row->str(1)] = std::stoul(row->str(2));
  for (const Constant& c : constants_in_table(markdown)) ++counted[c.origin.substr(0, 1)];
  EXPECT_EQ(stated, counted);
  EXPECT_THAT(stated, SizeIs(4));
}

TEST(Constants, AreThoseThatAreWrittenInNumbers) {
  const std::vector<SourceFile> files{
      {"firmware_core/dampline/guard/a.cpp",
       "constexpr double kGain = 7.0;  // constexpr int kNot = 1;\n"
       "constexpr std::array<double, kChannels> kRatio{6.0,\n    10.0};\n"
       "constexpr int kRing = 2 * kHalf + 1;\nconstexpr double kPi = std::numbers::pi;\n"
       "constexpr double twice(double kX) { return 2.0 * kX; }\nconstexpr double rate = 1.0;\n"},
      {"app/diagnosis/rig/bank.hpp", "static constexpr std::size_t kBins = 8 * 38 + 8U;\n"}};
  EXPECT_THAT(texts(constants_of(files)),
              ElementsAre("guard/a kGain = 7.0", "guard/a kRatio = {6.0, 10.0}",
                          "app/diagnosis/rig/bank kBins = 8 * 38 + 8U"));
}

TEST(Constants, AreReadFromTheRowsOfATable) {
  const std::vector<Constant> rows = constants_in_table(
      "text | kNo | 1\n| file | name | value | unit | decides | origin |\n|--|--|--|--|--|--|\n"
      "| guard/a | kGain | 7.0 | 1 | when | d |\n");
  EXPECT_THAT(texts(rows), ElementsAre("guard/a kGain = 7.0"));
}

TEST(Constants, AreMissedOneByOne) {
  const std::vector<Constant> two{{"a", "kX", "1"}, {"a", "kX", "1"}};
  EXPECT_THAT(missing_from({two[0]}, two), SizeIs(1));
  EXPECT_THAT(missing_from(two, two), IsEmpty());
  EXPECT_THAT(missing_from({{"a", "kX", "2"}}, {two[0]}), ElementsAre("a kX = 1"));
}

}  // namespace
}  // namespace dampline::proof

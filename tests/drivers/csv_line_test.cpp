// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "drivers/csv/line.hpp"

namespace dampline::drivers {
namespace {

using testing::ElementsAre;

TEST(CsvLine, TakesCellsWithoutTheirBlanksAndQuotes) {
  EXPECT_THAT(cells_of("a, b\t,\"c,d\", \"\" ,e", ','), ElementsAre("a", "b", "c,d", "", "e"));
  EXPECT_THAT(cells_of("a,b,", ','), ElementsAre("a", "b", ""));
  EXPECT_THAT(cells_of("", ','), ElementsAre(""));
  EXPECT_THAT(cells_of("\"", ','), ElementsAre("\""));
  EXPECT_THAT(cells_of("a;b,c", ';'), ElementsAre("a", "b,c"));
}

TEST(CsvLine, TakesCellsBetweenAnyNumberOfBlanks) {
  EXPECT_THAT(cells_of("  a \t b  \"c d\"  e  ", ' '), ElementsAre("a", "b", "c d", "e"));
  EXPECT_THAT(cells_of("a", ' '), ElementsAre("a"));
}

TEST(CsvLine, FindsTheMostFrequentSeparatorOutsideQuotes) {
  EXPECT_EQ(separator_of("a,b;c;d"), ';');
  EXPECT_EQ(separator_of("a,b,c;d"), ',');
  EXPECT_EQ(separator_of("a\tb\tc,d"), '\t');
  EXPECT_EQ(separator_of("\"a;b;c\",d"), ',');
  EXPECT_EQ(separator_of("a b c"), ' ');
  EXPECT_EQ(separator_of("a b,c"), ',');
  EXPECT_EQ(separator_of("a"), ',');
  EXPECT_EQ(separator_of("a "), ',');
}

double number_of(const std::string& cell, char separator = ';') {
  double number = 0.0;
  return read_number(cell, separator, number) ? number : -999.0;
}

TEST(CsvLine, ReadsNumbersWithAPointOrAComma) {
  EXPECT_EQ(number_of("1.5"), 1.5);
  EXPECT_EQ(number_of("+2e3"), 2000.0);
  EXPECT_EQ(number_of("-1,25"), -1.25);
  EXPECT_EQ(number_of("-1,25", ','), -999.0);
  EXPECT_EQ(number_of("+"), -999.0);
  EXPECT_EQ(number_of("+-1"), -999.0);
  EXPECT_EQ(number_of("1.5x"), -999.0);
  EXPECT_EQ(number_of("1,5,2"), -999.0);
  EXPECT_EQ(number_of("inf"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(number_of(fmt::format("0,{:061}1", 0)), 1e-62) << "64 characters";
  EXPECT_EQ(number_of(fmt::format("0,{:062}1", 0)), -999.0);
}

TEST(CsvLine, ReadsWordsForNoNumber) {
  for (const char* word : {"", "NA", "n/a", "#N/A", "Null", "none", "-", "NaN"})
    EXPECT_TRUE(std::isnan(number_of(word))) << word;
  for (const char* word : {"nan1", "N/B", "nul", "--", "zero"}) EXPECT_EQ(number_of(word), -999.0);
}

std::int64_t stamp_of(const std::string& cell) {
  const auto stamp = read_stamp(cell);
  return stamp ? stamp->utc_ns : -1;
}

TEST(CsvLine, ReadsDatesAndTimes) {
  EXPECT_EQ(stamp_of("1970-01-01T00:00:00Z"), 0);
  EXPECT_EQ(stamp_of("2020-09-13 12:26:40"), 1'600'000'000'000'000'000);
  EXPECT_EQ(stamp_of("2020/09/13 12:26"), 1'599'999'960'000'000'000);
  EXPECT_EQ(stamp_of("2020-09-13T12:26:40.25"), 1'600'000'000'250'000'000);
  EXPECT_EQ(stamp_of("2020-09-13T12:26:40,123456789123"), 1'600'000'000'123'456'789);
  EXPECT_EQ(stamp_of("2020-09-13T14:26:40+02:00"), 1'600'000'000'000'000'000);
  EXPECT_EQ(stamp_of("2020-09-13T10:56:40-0130"), 1'600'000'000'000'000'000);
  EXPECT_EQ(stamp_of("2020-09-13T14:26:40+02"), 1'600'000'000'000'000'000);
  EXPECT_EQ(stamp_of("2016-12-31T23:59:60Z"), 1'483'228'800'000'000'000) << "a leap second";
  EXPECT_EQ(stamp_of("2200-12-31T00:00:00"), 7'289'568'000'000'000'000);
  EXPECT_EQ(stamp_of("1970-01-01T14:59:00+14:59"), 0);
  EXPECT_TRUE(read_stamp("2020-09-13T12:26:40Z")->zone_is_named);
  EXPECT_TRUE(read_stamp("2020-09-13T12:26:40+00:00")->zone_is_named);
  EXPECT_FALSE(read_stamp("2020-09-13T12:26:40")->zone_is_named);
}

TEST(CsvLine, RefusesDatesAndTimesThatAreNone) {
  for (const char* cell : {"",
                           "2020",
                           "1969-12-31T00:00:00",
                           "2201-01-01T00:00:00",
                           "2020-13-01T00:00:00",
                           "2020-00-01T00:00:00",
                           "2020-02-30T00:00:00",
                           "2020-02-00T00:00:00",
                           "2020-2-01T00:00:00",
                           "2020-02-1T00:00:00",
                           "2020.02-01T00:00:00",
                           "2020-02.01T00:00:00",
                           "2020-02-01",
                           "2020-02-01x00:00:00",
                           "2020-02-01T24:00:00",
                           "2020-02-01T0:00:00",
                           "2020-02-01T00",
                           "2020-02-01T00.00:00",
                           "2020-02-01T00:60:00",
                           "2020-02-01T00:0",
                           "2020-02-01T00:00:61",
                           "2020-02-01T00:00:0",
                           "2020-02-01T00:00:00x",
                           "2020-02-01T00:00:00.",
                           "2020-02-01T00:00:00+15:00",
                           "2020-02-01T00:00:00+02:60",
                           "2020-02-01T00:00:00+2",
                           "2020-02-01T00:00:00+02:0",
                           "2020-02-01T00:00:00Z1",
                           "202a-02-01T00:00:00"})
    EXPECT_EQ(stamp_of(cell), -1) << cell;
}

}  // namespace
}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "drivers/candump/line.hpp"

namespace dampline::drivers {
namespace {

struct Parsed {
  CanFrame frame;
  std::string interface;
  std::string expected;  // empty: the line is good
  std::ptrdiff_t column{0};
};

Parsed parse(const std::string& line) {
  Parsed result;
  CanFrame& frame = result.frame;  // what another frame left behind
  frame.data.fill(0xEE);
  frame.id = 0x7FF;
  frame.length = 7;
  frame.fd_flags = 3;
  frame.extended = frame.remote = frame.error = frame.fd = true;
  CandumpLine parser;
  const CandumpFault fault = parser.parse(line, result.frame);
  if (fault.expected != nullptr) {
    result.expected = fault.expected;
    result.column = fault.at - line.data();
    return result;
  }
  result.interface = parser.interface_name();
  return result;
}

// can-utils writes `_9` to `_F` behind eight bytes where a frame's length code was larger.
TEST(CandumpLine, ReadsOverALengthCodeBehindEightBytes) {
  const Parsed line = parse("(1.500000) can0 0D0#A8FF00000000FF01_9");
  ASSERT_EQ(line.expected, "");
  EXPECT_EQ(line.frame.length, 8);
  EXPECT_EQ(line.frame.data[7], 0x01);
  EXPECT_NE(parse("(1.500000) can0 0D0#A8FF00000000FF_9").expected, "") << "behind seven";
  EXPECT_NE(parse("(1.500000) can0 0D0#A8FF00000000FF01_").expected, "");
  EXPECT_NE(parse("(1.500000) can0 0D0#A8FF00000000FF01_X").expected, "");
}

TEST(CandumpLine, ReadsAStandardFrame) {
  const Parsed line = parse("(1631416514.736052) can0 0D0#A8FF00000000FF01");
  ASSERT_EQ(line.expected, "");
  EXPECT_EQ(line.frame.time_ns, 1631416514736052000);
  EXPECT_EQ(line.interface, "can0");
  EXPECT_EQ(line.frame.id, 0x0D0U);
  EXPECT_FALSE(line.frame.extended || line.frame.remote || line.frame.error || line.frame.fd);
  EXPECT_EQ(line.frame.fd_flags, 0);
  EXPECT_EQ(line.frame.length, 8);
  EXPECT_EQ(line.frame.data[0], 0xA8);
  EXPECT_EQ(line.frame.data[7], 0x01);
  for (std::size_t i = 8; i < 64; ++i) EXPECT_EQ(line.frame.data[i], 0);
}

TEST(CandumpLine, ReadsNineDecimals) {
  EXPECT_EQ(parse("(1631416514.736052123) can0 0D0#").frame.time_ns, 1631416514736052123);
  EXPECT_EQ(parse("(0.000000001) can0 0D0#").frame.time_ns, 1);  // relative times
}

TEST(CandumpLine, ReadsTheLatestTimeThatFits) {
  EXPECT_EQ(parse("(9223372035.999999) can0 0D0#").frame.time_ns, 9'223'372'035'999'999'000);
}

/// What a parser that has read another line before makes of this one is what a new one makes of it.
TEST(CandumpLine, ReadsEveryLineAsIfItWereTheFirst) {
  const std::string digits = "0123456789";
  std::vector<std::string> lines{"(1631416514.736052) can0 0D0#A8",
                                 "(1631416514.736052) can0 0D0#"};
  for (const char c : std::string{"/09:.)( xA\x80\xFF"}) {
    for (std::size_t place = 0; place < 22; ++place) {
      lines.push_back(lines[0]);
      lines.back()[place] = c;
    }
  }
  for (const char c : digits) lines.push_back("(1631416514." + std::string(6, c) + ") can0 0D0#A8");
  lines.push_back(std::string(12, '\0') + "123456) can0 0D0#A8");
  for (const char* line :
       {"(1234567.123456789) can0 0D0#A8", "(1631416514.7360521) can0 0D0#A8",
        "(1631416514.736052123) can0 0D0#A8", "(1631416514.736052) .123456) 0D0#A8",
        "(1.000000) .123456) can0 0D0#A8", "(1.000000) .123457) 0D0#A8", "(1.000000) .1) 0D0#A8",
        "(1631416515.000001) can0 0D0#A8", "(1631416514.", "(1631416514.736052)", "(163"})
    lines.emplace_back(line);
  for (const std::string& before : lines) {
    for (const std::string& line : lines) {
      CanFrame frame;
      frame.data.fill(0xEE);
      CandumpLine parser;
      static_cast<void>(parser.parse(before, frame));
      const CandumpFault fault = parser.parse(line, frame);
      const Parsed fresh = parse(line);
      ASSERT_EQ(fault.expected == nullptr ? "" : fault.expected, fresh.expected) << before << line;
      if (fault.expected != nullptr) {
        ASSERT_EQ(fault.at - line.data(), fresh.column) << before << line;
      } else {
        ASSERT_EQ(frame.time_ns, fresh.frame.time_ns) << before << line;
        ASSERT_EQ(parser.interface_name(), fresh.interface) << before << line;
      }
    }
  }
}

TEST(CandumpLine, ReadsTheDirection) {
  EXPECT_EQ(parse("(1.000000) vcan12 123#11 R").expected, "");
  EXPECT_EQ(parse("(1.000000) vcan12 123#11 T").frame.length, 1);
  EXPECT_EQ(parse("(1.000000) vcan12 123#11  ").expected, "");
  EXPECT_NE(parse("(1.000000) vcan12 123#11 X").expected, "");
}

TEST(CandumpLine, ReadsExtendedErrorAndRemoteFrames) {
  const Parsed extended = parse("(1.000000) can0 18FF0001#1122");
  EXPECT_TRUE(extended.frame.extended);
  EXPECT_EQ(extended.frame.id, 0x18FF0001U);
  const Parsed low = parse("(1.000000) can0 00000123#");
  EXPECT_TRUE(low.frame.extended);
  EXPECT_EQ(low.frame.id, 0x123U);
  const Parsed error = parse("(1.000000) can0 20000080#0000000000000000");
  EXPECT_TRUE(error.frame.error);
  EXPECT_FALSE(error.frame.extended || error.frame.remote || error.frame.fd);
  EXPECT_EQ(error.frame.id, 0x80U);
  const Parsed remote = parse("(1.000000) can0 123#R");
  EXPECT_TRUE(remote.frame.remote);
  EXPECT_EQ(remote.frame.length, 0);
  EXPECT_EQ(remote.frame.data[0], 0);
  EXPECT_EQ(parse("(1.000000) can0 123#R8").frame.length, 8);
  EXPECT_EQ(parse("(1.000000) can0 123#r0").expected, "");
  EXPECT_NE(parse("(1.000000) can0 123#R9").expected, "") << "eight bytes at most";
}

TEST(CandumpLine, ReadsCanFd) {
  const Parsed twelve = parse("(1.000000) can0 123##1000102030405060708090A0B");
  ASSERT_EQ(twelve.expected, "");
  EXPECT_TRUE(twelve.frame.fd);
  EXPECT_EQ(twelve.frame.length, 12);
  EXPECT_EQ(twelve.frame.data[11], 0x0B);
  EXPECT_EQ(parse("(1.000000) can0 123##0" + std::string(128, 'F')).frame.length, 64);
  EXPECT_NE(parse("(1.000000) can0 123##0" + std::string(130, 'F')).expected, "");
  EXPECT_NE(parse("(1.000000) can0 123##0" + std::string(18, 'F')).expected,
            "");  // 9 bytes: no such length
  EXPECT_NE(parse("(1.000000) can0 123##").expected, "");
}

TEST(CandumpLine, TakesTheSixteenLengthsOfCanFdAndNoOther) {
  const std::vector<std::size_t> allowed{0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
  for (std::size_t length = 0; length <= 66; ++length) {
    const Parsed line = parse("(1.000000) can0 123##0" + std::string(2 * length, 'F'));
    const bool good = std::find(allowed.begin(), allowed.end(), length) != allowed.end();
    EXPECT_EQ(line.expected.empty(), good) << length;
    if (good) {
      EXPECT_EQ(line.frame.length, length);
    }
  }
}

TEST(CandumpLine, ReadsWhatCanUtilsAllows) {
  EXPECT_EQ(parse("(1.000000) can0 123#").frame.length, 0);
  EXPECT_EQ(parse("(1.000000) can0 1aB#fF").frame.data[0], 0xFF);
  EXPECT_EQ(parse("(1.000000) can0 123#11.22.33").frame.length, 3);
  EXPECT_EQ(parse("(1.000000) can012345678901 123#").interface, "can012345678901");
  EXPECT_EQ(parse("(1.000000) can0 123#1122334455667788_C").frame.length, 8);
  EXPECT_EQ(parse("(1.000000) a 123#").interface, "a");
  EXPECT_EQ(parse("(1.000000)   can0 123#").interface, "can0") << "set right";
  EXPECT_EQ(parse("(1.000000) can0 7FF#").frame.id, 0x7FFU);
  EXPECT_EQ(parse("(1.000000) can0 1FFFFFFF#").frame.id, 0x1FFFFFFFU);
}

struct Bad {
  const char* line;
  std::ptrdiff_t column;
};
class CandumpLineRefuses : public ::testing::TestWithParam<Bad> {};

TEST_P(CandumpLineRefuses, AndPointsAtTheCharacter) {
  const Parsed line = parse(GetParam().line);
  EXPECT_NE(line.expected, "") << GetParam().line;
  EXPECT_EQ(line.column, GetParam().column) << GetParam().line;
}

INSTANTIATE_TEST_SUITE_P(
    Lines, CandumpLineRefuses,
    ::testing::Values(
        Bad{"", 0}, Bad{"(", 1}, Bad{"(1631416514)", 11}, Bad{"(1.00000) can0 123#", 8},
        Bad{"(1.0000000) can0 123#", 10}, Bad{"(1.000000", 9}, Bad{"(1.000000)", 10},
        Bad{"(1.000000)can0 123#", 10}, Bad{"(1.000000) can0", 15}, Bad{"(1.000000) can0 ", 16},
        Bad{"(1.000000) can0 12#", 18}, Bad{"(1.000000) can0 1234#", 20},
        Bad{"(1.000000) can0 800#", 20}, Bad{"(1.000000) can0 123 11", 19},
        Bad{"(1.000000) can0 C0000000#", 25}, Bad{"(1.000000) can0 123#1", 20},
        Bad{"(1.000000) can0 123#112233445566778899", 36}, Bad{"(1.000000) can0 123#1G", 20},
        Bad{"(1.000000) can0123456789012 123#", 27}, Bad{"(-1.000000) can0 123#", 1},
        Bad{"(9223372036.000000) can0 123#", 11}, Bad{"(99999999999999.000000) can0 123#", 12},
        Bad{"(1.000000) c\xC3\xA4n 123#", 12}, Bad{"(1.000000) c\x7F 123#", 12},
        Bad{"(1:.000000) can0 123#", 2}, Bad{"(1.00000000000) can0 123#", 13},
        Bad{"(1.000000) can0 1234567890#", 25}, Bad{"(1.000000) can0 123#1:", 20},
        Bad{"(1.000000) can0 123#11 A", 23}, Bad{"(1.000000) can0 123#11223344556677_C", 34},
        Bad{"(1.000000) can0 123#1122334455667788_G", 36},
        Bad{"(1.000000) can0 123#1122334455667788_", 36}, Bad{"(1.000000)  ", 12},
        Bad{"(1.000000) can0#123#", 15}, Bad{"(1.000000) can0 123##G", 21}));

}  // namespace
}  // namespace dampline::drivers

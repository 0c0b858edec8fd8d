// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "drivers/candump/interface_table.hpp"
#include "drivers/candump/screen.hpp"
#include "tests/drivers/parsed_line.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::drivers {
namespace {

using Kind = FrameLineParser::Kind;

/// What a new parser makes of one line.
struct OfScreen : ParsedLine {
  RecordClock clock{};
};
OfScreen screen_line(const std::string& line) {
  CandumpScreen parser{false, std::nullopt};
  CanFrame before;
  before.data.fill(0xEE);
  const ParsedLine out = parsed(parser, line, before);
  return {out, parser.clock()};
}

std::int64_t time_of(const std::string& text) {
  const OfScreen out = screen_line(fmt::format("({})  can0  123   [1]  11", text));
  return out.kind == Kind::kFrame ? out.frame.time_ns : -1;
}

TEST(CandumpScreen, ReadsATimeOfDayAsUtc) {
  EXPECT_EQ(time_of("1970-01-01 00:00:00.000000"), 0);
  EXPECT_EQ(time_of("1970-01-02 00:00:00.000001"), 86'400'000'001'000);
  EXPECT_EQ(time_of("2020-09-13 12:26:40.123456"), 1'600'000'000'123'456'000);
  EXPECT_EQ(time_of("2024-02-29 23:59:59.999999"), 1'709'251'199'999'999'000);
  EXPECT_EQ(time_of("2200-12-31 00:00:00.0"), 7'289'568'000'000'000'000);
  EXPECT_EQ(time_of("2020-09-13 12:26:40"), 1'600'000'000'000'000'000) << "to the second";
  EXPECT_EQ(time_of("2016-12-31 23:59:60.500000"), 1'483'228'800'500'000'000) << "a leap second";
  EXPECT_EQ(screen_line("(2020-09-13 12:26:40.1) can0 123 [0]").clock, RecordClock::kLocal);
}

TEST(CandumpScreen, RefusesATimeOfDayThatIsNone) {
  for (const char* text :
       {"2023-02-29 12:00:00.0", "2020-13-01 12:00:00.0", "2020-00-01 12:00:00.0",
        "2020-09-31 12:00:00.0", "2020-09-00 12:00:00.0", "1969-12-31 12:00:00.0",
        "2201-01-01 12:00:00.0", "2020-09-13 24:00:00.0", "2020-09-13 12:60:00.0",
        "2020-09-13 12:00:61.1", "2020-09-13 12:00",      "2020/09-13 12:00:00.0",
        "2020-09/13 12:00:00.0", "2020-09-13 12.00:00.0", "x020-09-13 12:00:00.0",
        "2020-x9-13 12:00:00.0", "2020-09-x3 12:00:00.0", "2020-09-13 x2:00:00.0",
        "2020-09-13 12:x0:00.0", "2020-09-13 12:00:x0.0"}) {
    const OfScreen out = screen_line(fmt::format("({}) can0 123 [0]", text));
    EXPECT_EQ(out.kind, Kind::kBad) << text;
    EXPECT_EQ(out.expected, "seconds, or a date and a time of day");
    EXPECT_EQ(out.column, 1);
  }
}

// Ten digits are seconds since 1970, fewer those since the first frame.
TEST(CandumpScreen, TellsSecondsSince1970FromThoseSinceTheFirstFrame) {
  EXPECT_EQ(time_of("1600000001.000300"), 1'600'000'001'000'300'000);
  EXPECT_EQ(screen_line("(1600000001.000300) can0 123 [0]").clock, RecordClock::kUtc);
  EXPECT_EQ(time_of("000000012.5"), 12'500'000'000);
  EXPECT_EQ(screen_line("(160000001.000300) can0 123 [0]").clock, RecordClock::kRelative);
}

TEST(CandumpScreen, AddsUpTimesBetweenFrames) {
  for (const bool deltas : {false, true}) {
    CandumpScreen parser{deltas, std::nullopt};
    std::vector<std::int64_t> times;
    for (const char* text : {"000.000000", "000.100000", "000.050000"}) {
      CanFrame frame;
      std::string_view interface;
      const std::string line = fmt::format(" ({})  can0  123   [1]  11", text);
      ASSERT_EQ(parser.parse(line, frame, interface).kind, Kind::kFrame);
      times.push_back(frame.time_ns);
    }
    EXPECT_THAT(times, testing::ElementsAre(0, 100'000'000, deltas ? 150'000'000 : 50'000'000));
  }
}

TEST(CandumpScreen, ReadsIdentifiersAndFlags) {
  const OfScreen plain = screen_line("(1.0)  can0  7FF   [3]  11 22 33");
  ASSERT_EQ(plain.kind, Kind::kFrame) << plain.expected;
  EXPECT_EQ(plain.interface, "can0");
  EXPECT_EQ(plain.frame.id, 0x7FFU);
  EXPECT_EQ(plain.frame.length, 3);
  EXPECT_EQ(plain.frame.data[2], 0x33);
  EXPECT_EQ(plain.frame.data[3], 0) << "nothing of the frame before";
  EXPECT_FALSE(plain.frame.extended || plain.frame.fd || plain.frame.error || plain.frame.remote);
  const OfScreen wide = screen_line("(1.0)  can0  1FFFFFFF   [0]");
  EXPECT_TRUE(wide.frame.extended);
  EXPECT_FALSE(wide.frame.error);
  const OfScreen error = screen_line("(1.0)  can0  20000080   [1]  01   ERRORFRAME");
  EXPECT_TRUE(error.frame.error);
  EXPECT_FALSE(error.frame.extended);
  EXPECT_EQ(error.frame.id, 0x80U);
  EXPECT_EQ(screen_line("(1.0) can0 RX B E 123 [01] 11").frame.fd_flags, 3);
  EXPECT_EQ(screen_line("(1.0) can0 TX - E 123 [01] 11").frame.fd_flags, 2);
  EXPECT_EQ(screen_line("(1.0) can0 TX B - 123 [1] 11").frame.fd_flags, 0) << "of CAN FD alone";
}

// candump writes lengths of CAN FD frames with two digits.
TEST(CandumpScreen, KnowsCanFdByTheFormOfItsLength) {
  EXPECT_TRUE(screen_line("(1.0) can0 123 [08] 1 2 3 4 5 6 7 8").frame.fd);
  EXPECT_FALSE(screen_line("(1.0) can0 123 [8] 1 2 3 4 5 6 7 8").frame.fd);
  EXPECT_FALSE(screen_line("(1.0) can0 123 [0]").frame.fd);
  EXPECT_TRUE(screen_line("(1.0) can0 123 [00]").frame.fd);
  EXPECT_TRUE(screen_line("(1.0) can0 123 [12] 1 2 3 4 5 6 7 8 9 A B C").frame.fd);
  std::string bytes;
  for (int i = 0; i < 64; ++i) bytes += " 5A";
  const OfScreen full = screen_line("(1.0) can0 123 [64]" + bytes);
  EXPECT_EQ(full.frame.length, 64);
  EXPECT_EQ(full.frame.data[63], 0x5A);
  EXPECT_EQ(screen_line("(1.0) can0 123 [65]" + bytes + " 5A").kind, Kind::kBad);
}

TEST(CandumpScreen, ARemoteFrameAsksForEightBytesAtMost) {
  const OfScreen remote = screen_line("(1.0) can0 123 [3]  remote request");
  EXPECT_TRUE(remote.frame.remote);
  EXPECT_EQ(remote.frame.length, 3);
  EXPECT_EQ(screen_line("(1.0) can0 123 [12]  remote request").frame.length, 8);
}

TEST(CandumpScreen, PointsAtWhatDoesNotFit) {
  for (const auto& [line, column, expected] :
       {std::tuple{"(1.0) can0 800 [0]", 11, "an identifier of 11 or 29 bits"},
        std::tuple{"(1.0) can0 C0000000 [0]", 11, "an identifier of 11 or 29 bits"},
        std::tuple{"(1.0) can0 1234 [0]", 11, "3 or 8 hexadecimal digits"},
        std::tuple{"(1.0) can0 12X [0]", 11, "3 or 8 hexadecimal digits"},
        std::tuple{"(1.0) can0123456789012 123 [0]", 6, "an interface of 1 to 15 characters"},
        std::tuple{"(1.0) can0 123 {0}", 15, "a length in brackets"},
        std::tuple{"(1.0) can0 123 [x]", 15, "a length in brackets"},
        std::tuple{"(1.0) can0 123 []", 15, "a length in brackets"},
        std::tuple{"(1.0) can0 123 [2] 11 2G", 22, "two hexadecimal digits a byte"},
        std::tuple{"(1.0) can0 123 [2] 11 222", 22, "two hexadecimal digits a byte"},
        std::tuple{"(1x) can0 123 [0]", 1, "seconds, or a date and a time of day"}}) {
    const OfScreen out = screen_line(line);
    EXPECT_EQ(out.kind, Kind::kBad) << line;
    EXPECT_EQ(out.expected, expected) << line;
    EXPECT_EQ(out.column, column) << line;
  }
  EXPECT_EQ(screen_line("(1.0) can0123456789 123 [0]").kind, Kind::kFrame);
  EXPECT_EQ(screen_line("interface can0 is up").kind, Kind::kNoFrame);
  EXPECT_EQ(screen_line("").kind, Kind::kNoFrame);
}

TEST(CandumpScreen, StampsFramesWithoutTimesByTheirInstants) {
  CandumpScreen parser{false, UntimedFrames{.id = 0x100, .extended = false, .period_s = 0.01}};
  EXPECT_TRUE(parser.notes().empty());
  std::vector<std::int64_t> times;
  for (const char* line : {"can0 101 [0]", "can0 100 [0]", "can0 101 [0]", "can0 00000100 [0]",
                           "can0 100 [1] remote request", "can0 20000100 [0]", "can0 100 [0]"}) {
    CanFrame frame;
    std::string_view interface;
    ASSERT_EQ(parser.parse(line, frame, interface).kind, Kind::kFrame);
    times.push_back(frame.time_ns);
  }
  EXPECT_THAT(times, testing::ElementsAre(0, 10'000'000, 10'000'000, 10'000'000, 10'000'000,
                                          10'000'000, 20'000'000));
  ASSERT_EQ(parser.notes().size(), 1U);
  EXPECT_THAT(parser.notes()[0], testing::HasSubstr("10 ms apart"));
}

TEST(CandumpScreen, LeavesFramesWithoutTimesAloneWhereNobodySaysHowFarApartTheyAre) {
  const OfScreen out = screen_line("can0 123 [1] 11");
  EXPECT_EQ(out.kind, Kind::kFrame);
  EXPECT_EQ(out.frame.time_ns, 0);
}

TEST(CandumpScreen, KnowsTimesBetweenFramesByThoseThatGoBack) {
  const auto differences = [](const std::string& text) {
    const test::TemporaryFile file{text};
    return has_time_differences(file.path());
  };
  const std::string tail = "  can0  123   [0]\n";
  EXPECT_TRUE(differences("(0.0)" + tail + "(0.2)" + tail + "(0.1)" + tail));
  EXPECT_FALSE(differences("(0.0)" + tail + "(0.2)" + tail + "(0.2)" + tail));
  EXPECT_FALSE(differences("(1600000000.2)" + tail + "(1600000000.1)" + tail));
  EXPECT_TRUE(differences("(0.2)" + tail + "a comment\n(0.1)" + tail));
  EXPECT_FALSE(differences(""));
  std::string late;
  for (int i = 0; i < 99; ++i) late += "(0.2)" + tail;
  EXPECT_TRUE(differences(late + "(0.1)" + tail));
  EXPECT_FALSE(differences(late + "(0.2)" + tail + "(0.1)" + tail)) << "a hundred lines";
  EXPECT_FALSE(has_time_differences("/nonexistent"));
}

TEST(InterfaceTable, NumbersNamesAsTheyAppearAndHoldsTwoHundredAndFiftyFive) {
  InterfaceTable table;
  EXPECT_EQ(table.index_of("can1"), 0);
  EXPECT_EQ(table.index_of("can0"), 1);
  EXPECT_EQ(table.index_of("can1"), 0);
  EXPECT_EQ(table.index_of("can"), 2);
  EXPECT_EQ(table.index_of("can0"), 1);
  EXPECT_EQ(table.size(), 3U);
  EXPECT_EQ(table.name(1), "can0");
  for (std::size_t i = 3; i < 255; ++i)
    EXPECT_EQ(table.index_of(fmt::format("a{}", i)), static_cast<std::uint8_t>(i));
  EXPECT_EQ(table.index_of("one_too_many"), std::nullopt);
  EXPECT_EQ(table.index_of("a254"), 254);
  EXPECT_EQ(table.index_of("can1"), 0);
}

}  // namespace
}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "drivers/asc/parser.hpp"
#include "drivers/trc/parser.hpp"
#include "tests/drivers/parsed_line.hpp"

namespace dampline::drivers {
namespace {

/// What a parser makes of the last of some lines.
template <class Parser>
ParsedLine last_of(const std::vector<std::string>& lines) {
  Parser parser;
  ParsedLine out;
  for (const std::string& line : lines) out = parsed(parser, line);
  return out;
}

ParsedLine asc(const std::string& line) { return last_of<AscParser>({line}); }
ParsedLine trc(const std::string& version, const std::string& line) {
  return last_of<TrcParser>({";$FILEVERSION=" + version, line});
}
constexpr auto kFrame = FrameLineParser::Kind::kFrame;
constexpr auto kNoFrame = FrameLineParser::Kind::kNoFrame;
constexpr auto kBad = FrameLineParser::Kind::kBad;

TEST(AscLine, ReadsClassicFrames) {
  const ParsedLine plain = asc(" 1.25 3 7FF Rx d 2 0A FF");
  ASSERT_EQ(plain.kind, kFrame) << plain.expected;
  EXPECT_EQ(plain.frame.time_ns, 1'250'000'000);
  EXPECT_EQ(plain.interface, "can3");
  EXPECT_EQ(plain.frame.id, 0x7FFU);
  EXPECT_FALSE(plain.frame.extended || plain.frame.remote || plain.frame.fd || plain.frame.error);
  EXPECT_EQ(plain.frame.length, 2);
  EXPECT_EQ(plain.frame.data[1], 0xFF);
  const ParsedLine wide = asc("1.0 255 1FFFFFFFX TxRq d 0");
  EXPECT_TRUE(wide.frame.extended);
  EXPECT_EQ(wide.interface, "can255");
  EXPECT_EQ(asc("1.0 1 1x Tx d 9 1 2 3 4 5 6 7 8").frame.length, 8);
  EXPECT_EQ(asc("1.0 1 123 Rx r").frame.length, 0);
  EXPECT_TRUE(asc("1.0 1 123 Rx r").frame.remote);
  EXPECT_EQ(asc("1.0 1 123 Rx r 9").frame.length, 8);
  EXPECT_TRUE(asc("1.0 1 ErrorFrame Flags = 0xe").frame.error);
}

TEST(AscLine, PassesOverWhatIsNoFrame) {
  for (const char* line :
       {"", "// 1.0 1 123 Rx d 0", "1 1 123 Rx d 0", "1.0 0 123 Rx d 0", "1.0 256 123 Rx d 0",
        "1.0 x 123 Rx d 0", "1.0 1 123 Up d 0", "1.0 1 123 Rx x 0", "1.0 CANFD 1 Up 123 0 0 8 0",
        "1.0 1 Statistic: D 0", "date Tue Nov 14 10:13:20 2023"})
    EXPECT_EQ(asc(line).kind, kNoFrame) << line;
}

TEST(AscLine, PointsAtWhatDoesNotFit) {
  for (const auto& [line, column] :
       {std::tuple{"1.0 1 800 Rx d 0", 6}, std::tuple{"1.0 1 20000000x Rx d 0", 6},
        std::tuple{"1.0 1 12G Rx d 0", 6}, std::tuple{"1.0 1 123 Rx d G", 15},
        std::tuple{"1.0 1 123 Rx d 2 11 GG", 20}, std::tuple{"1.0 1 123 Rx r x", 15},
        std::tuple{"1.0 CANFD 1 Rx 800 0 0 8 8 1 2 3 4 5 6 7 8", 15},
        std::tuple{"1.0 CANFD 1 Rx 123 0 0 10 8", 23},
        std::tuple{"1.0 CANFD 1 Rx 123 0 0 f 65", 25},
        std::tuple{"1.0 CANFD 1 Rx 123 0 0 2 2 11 1G", 30}}) {
    const ParsedLine out = asc(line);
    EXPECT_EQ(out.kind, kBad) << line;
    EXPECT_EQ(out.column, column) << line;
  }
  EXPECT_EQ(asc("1.0 1 123 Rx d").column, -1) << "the line's end";
  EXPECT_EQ(asc("1.0 1 123 Rx d").kind, kBad);
}

TEST(AscLine, TakesBaseAndRelativeTimesFromTheHeader) {
  EXPECT_EQ(last_of<AscParser>({"base dec timestamps absolute", "1.0 1 291 Rx d 1 255"}).frame.id,
            291U);
  EXPECT_EQ(last_of<AscParser>({"base hex timestamps absolute", "1.0 1 291 Rx d 1 25"}).frame.id,
            0x291U);
  const std::vector<std::string> lines{"base hex  Timestamps RELATIVE", "1.5 1 1 Rx d 0",
                                       "0.25 1 1 Rx d 0"};
  EXPECT_EQ(last_of<AscParser>(lines).frame.time_ns, 1'750'000'000);
  const std::vector<std::string> absolute{"base hex timestamps absolute", "1.5 1 1 Rx d 0",
                                          "0.25 1 1 Rx d 0"};
  EXPECT_EQ(last_of<AscParser>(absolute).frame.time_ns, 250'000'000);
}

TEST(AscLine, ReadsCanFdFrames) {
  const ParsedLine out =
      asc("1.0 CANFD 2 Rx 1ABCDEFx Name 1 1 9 12 1 2 3 4 5 6 7 8 9 A B C 130 130 3000");
  ASSERT_EQ(out.kind, kFrame) << out.expected;
  EXPECT_TRUE(out.frame.fd && out.frame.extended);
  EXPECT_EQ(out.frame.fd_flags, 3);
  EXPECT_EQ(out.frame.length, 12);
  EXPECT_EQ(out.frame.data[11], 0x0C);
  EXPECT_EQ(asc("1.0 CANFD 1 Rx 1 1 0 1 1 5 130 130 3000").frame.fd_flags, 1);
  EXPECT_EQ(asc("1.0 CANFD 1 Rx 1 0 1 1 1 5 130 130 1000").frame.fd_flags, 2);
  const ParsedLine remote = asc("1.0 CANFD 1 Rx 1 0 0 4 0 130 130 10");
  EXPECT_TRUE(remote.frame.remote);
  EXPECT_FALSE(remote.frame.fd);
  EXPECT_EQ(remote.frame.length, 4);
  EXPECT_EQ(asc("1.0 CANFD 1 Rx 1 0 0 f 0").frame.length, 8);
  EXPECT_FALSE(asc("1.0 CANFD 1 Rx 1 0 0 0 0 130 130 1000").frame.remote) << "none at all";
  EXPECT_TRUE(asc("1.0 CANFD 1 Rx ErrorFrame").frame.error);
  EXPECT_TRUE(asc("1.0 CANFD 1 Rx 1 0 0 1 1 5 130 130 1000").frame.fd);
  EXPECT_FALSE(asc("1.0 CANFD 1 Rx 1 0 0 1 1 5 130 130 0").frame.fd)
      << "a classic one, by its flags";
  EXPECT_TRUE(asc("1.0 CANFD 1 Rx 1 0 0 1 1 5").frame.fd);
}

// A remote frame is classic, whatever flags stand in its line.
TEST(AscLine, ReadsRemoteFramesInCanFdLines) {
  const ParsedLine out = asc("1.0 CANFD 1 Rx 1 1 1 1 0 130 130 3000");
  ASSERT_EQ(out.kind, kFrame) << out.expected;
  EXPECT_TRUE(out.frame.remote);
  EXPECT_FALSE(out.frame.fd);
  EXPECT_EQ(out.frame.fd_flags, 0);
  EXPECT_EQ(out.frame.length, 1);
}

TEST(AscLine, TellsClassicFromCanFdWhereTheFlagsDo) {
  std::string bytes;
  for (int i = 0; i < 64; ++i) bytes += " 11";
  const ParsedLine longest = asc("1.0 CANFD 1 Rx 1 0 0 f 64" + bytes + " 130 130 0");
  ASSERT_EQ(longest.kind, kFrame) << longest.expected;
  EXPECT_EQ(longest.frame.length, 64);
  EXPECT_TRUE(longest.frame.fd) << "no classic frame is so long";
  EXPECT_FALSE(asc("1.0 CANFD 1 Rx 1 0 0 8 8 1 2 3 4 5 6 7 8 130 130 0").frame.fd);
  EXPECT_TRUE(asc("1.0 CANFD 1 Rx 1 0 0 9 12 1 2 3 4 5 6 7 8 9 A B C 130 130 0").frame.fd);
  EXPECT_TRUE(asc("1.0 CANFD 1 Rx 1 1 0 1 1 5 130 130 0").frame.fd) << "BRS is of CAN FD";
  EXPECT_TRUE(asc("1.0 CANFD 1 Rx 1 0 1 1 1 5 130 130 0").frame.fd) << "ESI is of CAN FD";
  EXPECT_FALSE(asc("1.0 CANFD 1 Rx 1 0 0 1 1 5 130 130 EFFF").frame.fd);
}

TEST(TrcLine, ReadsEachTypeOfFrame) {
  for (const auto& [type, fd, flags, remote, error] :
       {std::tuple{"DT", false, 0, false, false}, std::tuple{"FD", true, 0, false, false},
        std::tuple{"FB", true, 1, false, false}, std::tuple{"FE", true, 2, false, false},
        std::tuple{"BI", true, 3, false, false}, std::tuple{"RR", false, 0, true, false},
        std::tuple{"ER", false, 0, false, true}}) {
    const ParsedLine out = trc("2.0", std::string{" 1 1059.9 "} + type + " 0300 Rx 2 01 02");
    ASSERT_EQ(out.kind, kFrame) << type;
    EXPECT_EQ(out.frame.time_ns, 1'059'900'000);
    EXPECT_EQ(out.interface, "can1");
    EXPECT_EQ(out.frame.fd, fd) << type;
    EXPECT_EQ(out.frame.fd_flags, flags) << type;
    EXPECT_EQ(out.frame.remote, remote) << type;
    EXPECT_EQ(out.frame.error, error) << type;
    EXPECT_EQ(out.frame.length, 2);
    EXPECT_EQ(out.frame.data[1], remote || error ? 0 : 2);
  }
  for (const char* type : {"ST", "EC", "EV"})
    EXPECT_EQ(trc("2.0", std::string{" 1 1.0 "} + type + " 0300 Rx 0").kind, kNoFrame);
}

TEST(TrcLine, TellsExtendedIdentifiersByTheirDigits) {
  EXPECT_FALSE(trc("1.1", "1) 1.0 Rx 07FF 0").frame.extended);
  EXPECT_TRUE(trc("1.1", "1) 1.0 Rx 000007FF 0").frame.extended);
  EXPECT_EQ(trc("1.1", "1) 1.0 Rx 1FFFFFFF 0").frame.id, 0x1FFFFFFFU);
  EXPECT_EQ(trc("1.1", "1) 1.0 Rx 0800 0").column, 10);
  EXPECT_EQ(trc("1.1", "1) 1.0 Rx 20000000 0").kind, kBad);
  EXPECT_EQ(trc("1.1", "1) 1.0 Rx FFFFFFFF 4 00 00 00 08").kind, kNoFrame);
  EXPECT_EQ(trc("1.1", "1) 1.0 Rx xx 0").kind, kBad);
}

// L: the code of a CAN FD length, or a length up to eight; l: the length itself.
TEST(TrcLine, ReadsLengthsAndTheirCodes) {
  std::string bytes;
  for (int i = 0; i < 64; ++i) bytes += " 11";
  EXPECT_EQ(trc("2.1", "1 1.0 FD 1 0300 Rx - 15" + bytes).frame.length, 64);
  EXPECT_EQ(trc("2.1", "1 1.0 FD 1 0300 Rx - 9" + bytes).frame.length, 12);
  EXPECT_EQ(trc("2.1", "1 1.0 DT 1 0300 Rx - 9" + bytes).frame.length, 8);
  EXPECT_EQ(trc("2.1", "1 1.0 FD 1 0300 Rx - 8" + bytes).frame.length, 8);
  EXPECT_EQ(trc("2.1", "1 1.0 FD 1 0300 Rx - 16" + bytes).kind, kBad);
  EXPECT_EQ(trc("2.0", "1 1.0 FD 0300 Rx 64" + bytes).frame.length, 64);
  EXPECT_EQ(trc("2.0", "1 1.0 FD 0300 Rx 65" + bytes).kind, kBad);
  EXPECT_EQ(trc("2.0", "1 1.0 DT 0300 Rx x").kind, kBad);
}

TEST(TrcLine, ReadsBusesFromOneOn) {
  EXPECT_EQ(trc("1.2", "1) 1.0 255 Rx 0300 0").interface, "can255");
  EXPECT_EQ(trc("1.2", "1) 1.0 0 Rx 0300 0").kind, kBad);
  EXPECT_EQ(trc("1.2", "1) 1.0 256 Rx 0300 0").kind, kBad);
  EXPECT_EQ(trc("1.2", "1) x 1 Rx 0300 0").column, 3);
  const std::vector<std::string> lines{";$FILEVERSION=1.2", "1) 1.0 7 Rx 0300 0",
                                       ";$FILEVERSION=1.1", "2) 2.0 Rx 0300 0"};
  EXPECT_EQ(last_of<TrcParser>(lines).interface, "can1") << "without a column for it";
}

TEST(TrcLine, ARemoteFrameMaySayRtr) {
  const ParsedLine out = trc("1.1", "1) 1.0 Rx 0300 3 RTR");
  EXPECT_TRUE(out.frame.remote);
  EXPECT_EQ(out.frame.length, 3);
  EXPECT_EQ(trc("1.1", "1) 1.0 Rx 0300 3 11 22").kind, kBad);
}

TEST(TrcLine, TakesItsColumnsFromTheHeader) {
  const ParsedLine out =
      last_of<TrcParser>({";$FILEVERSION=2.0", ";$COLUMNS=I, O, T, l, D  ", "0300 7.5 DT 1 AB"});
  ASSERT_EQ(out.kind, kFrame) << out.expected;
  EXPECT_EQ(out.frame.id, 0x300U);
  EXPECT_EQ(out.frame.time_ns, 7'500'000);
  EXPECT_EQ(out.frame.data[0], 0xAB);
  EXPECT_EQ(last_of<TrcParser>({";$FILEVERSION=1.1 ", "1) 1.0 Tx 0300 0"}).kind, kFrame);
  EXPECT_EQ(last_of<TrcParser>({";$FILEVERSION=1.1  ", "1) 1.0 Tx 0300 0"}).kind, kFrame);
  EXPECT_EQ(last_of<TrcParser>({"; a comment"}).kind, kNoFrame);
  EXPECT_EQ(last_of<TrcParser>({"   "}).kind, kNoFrame);
  for (const auto& [version, read] :
       {std::pair{"1.0", true}, std::pair{"2.1", true}, std::pair{"2.2", false}}) {
    TrcParser parser;
    CanFrame frame;
    std::string_view interface;
    const std::string line = std::string{";$FILEVERSION="} + version;
    static_cast<void>(parser.parse(line, frame, interface));
    EXPECT_EQ(parser.refusal().empty(), read) << version;
  }
}

}  // namespace
}  // namespace dampline::drivers

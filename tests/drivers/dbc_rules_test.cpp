// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "drivers/dbc/channel.hpp"
#include "drivers/dbc/parse.hpp"

namespace dampline::drivers {
namespace {

using testing::HasSubstr;

/// A message of these signals, parsed.
Outcome<Dbc> message_of(const std::string& signals, const std::string& head = "BO_ 1 A: 8 X") {
  return parse_dbc(head + "\n" + signals + "\n", "rules.dbc");
}
/// One signal of the whole line but its name, as a channel.
Outcome<ChannelConfig> channel_of_line(const std::string& rest,
                                       const std::string& head = "BO_ 1 A: 8 X") {
  const auto dbc = message_of(" SG_ S : " + rest, head);
  if (!dbc.ok()) return dbc.failure();
  return channel_from(dbc.value(), "A.S", "");
}

TEST(DbcRules, TakesUnitsOfAcceleration) {
  constexpr double kG = 9.80665;
  for (const auto& [unit, mps2] :
       {std::pair{"", 1.0}, std::pair{"m/s^2", 1.0}, std::pair{"m/s2", 1.0}, std::pair{"ms-2", 1.0},
        std::pair{"m s-2", 1.0}, std::pair{"g", kG}, std::pair{"G", kG}, std::pair{"g0", kG},
        std::pair{"gn", kG}, std::pair{"mg", 1e-3 * kG}, std::pair{"mG", 1e-3 * kG},
        std::pair{"mm/s^2", 1e-3}}) {
    const auto channel = channel_of_line(fmt::format("0|16@1- (2,3) [-4|5] \"{}\" X", unit));
    ASSERT_TRUE(channel.ok()) << unit << channel.error_text();
    EXPECT_DOUBLE_EQ(channel.value().accel.scale, 2.0 * mps2) << unit;
    EXPECT_DOUBLE_EQ(channel.value().accel.offset, 3.0 * mps2);
    EXPECT_DOUBLE_EQ(channel.value().accel.minimum, -4.0 * mps2);
    EXPECT_DOUBLE_EQ(channel.value().accel.maximum, 5.0 * mps2);
  }
  for (const char* unit : {"km/h", "rad/s", "kg", "deg", "V", "gg"})
    EXPECT_THAT(channel_of_line(fmt::format("0|16@1- (1,0) [0|0] \"{}\" X", unit)).error_text(),
                HasSubstr("expected an acceleration"));
}

// A double holds 53 bits exactly; a counter and a multiplexor may have 64.
TEST(DbcRules, AnAccelerationHas53BitsAtMostAndACounter64) {
  for (const auto& [bits, good] :
       {std::tuple{1, true}, std::tuple{53, true}, std::tuple{54, false}, std::tuple{0, false}})
    EXPECT_EQ(channel_of_line(fmt::format("0|{}@1- (1,0) [0|0] \"g\" X", bits)).ok(), good) << bits;
  for (const auto& [bits, good] : {std::tuple{64, true}, std::tuple{65, false}}) {
    const auto dbc = message_of(fmt::format(" SG_ S : 0|16@1- (1,0) [0|0] \"g\" X\n"
                                            " SG_ N : 0|{}@1+ (1,0) [0|0] \"\" X",
                                            bits),
                                "BO_ 1 A: 16 X");
    EXPECT_EQ(channel_from(dbc.value(), "A.S", "A.N").ok(), good) << bits;
    const auto multiplexed = message_of(fmt::format(" SG_ S m1 : 64|16@1- (1,0) [0|0] \"g\" X\n"
                                                    " SG_ N M : 0|{}@1+ (1,0) [0|0] \"\" X",
                                                    bits),
                                        "BO_ 1 A: 16 X");
    EXPECT_EQ(channel_from(multiplexed.value(), "A.S", "").ok(), good) << bits;
  }
}

// Bits of the last byte are within, those of the next are not, in either order.
TEST(DbcRules, ASignalLiesWithinItsMessage) {
  for (const auto& [place, length, good] :
       {std::tuple{"16|8@1-", 3, true}, std::tuple{"17|8@1-", 3, false},
        std::tuple{"23|8@0-", 3, true}, std::tuple{"22|8@0-", 3, false},
        std::tuple{"16|8@1-", 2, false}, std::tuple{"504|8@1-", 64, true},
        std::tuple{"505|8@1-", 64, false}}) {
    const auto channel = channel_of_line(fmt::format("{} (1,0) [0|0] \"g\" X", place),
                                         fmt::format("BO_ 1 A: {} X", length));
    EXPECT_EQ(channel.ok(), good) << place << " of " << length;
  }
}

TEST(DbcRules, AnIdentifierHas11Or29Bits) {
  const auto id_of = [](std::uint64_t id) {
    return channel_of_line("0|8@1- (1,0) [0|0] \"g\" X", fmt::format("BO_ {} A: 8 X", id));
  };
  EXPECT_TRUE(id_of(0x7FF).ok());
  EXPECT_FALSE(id_of(0x7FF).value().extended);
  EXPECT_THAT(id_of(0x800).error_text(), HasSubstr("identifier 2048, expected 11 or 29 bits"));
  EXPECT_TRUE(id_of(0x9FFFFFFF).ok());
  EXPECT_TRUE(id_of(0x9FFFFFFF).value().extended);
  EXPECT_EQ(id_of(0x9FFFFFFF).value().id, 0x1FFFFFFFU);
  EXPECT_FALSE(id_of(0x1FFFFFFFF).ok()) << "no 32 bits";
}

/// The counter that is guessed beside signal S; empty: none.
std::string guessed(const std::string& signals, const std::string& mark = "") {
  const auto dbc = message_of(" SG_ S" + mark + " : 0|8@1- (1,0) [0|0] \"g\" X\n" + signals + "\n");
  const DbcMessage& message = dbc.value().messages[0];
  const DbcSignal* const found = guess_counter(message, message.signals[0]);
  return found == nullptr ? "" : found->name;
}
std::string unsigned_signal(const std::string& name) {
  return " SG_ " + name + " : 8|8@1+ (1,0) [0|0] \"\" X\n";
}

TEST(DbcRules, GuessesACounterByItsNameInThisOrder) {
  std::string signals;
  for (const char* name : {"alive", "MySeqNo", "msgcnt", "RollingCounter"}) {
    signals += unsigned_signal(name);
    EXPECT_EQ(guessed(signals), name) << "before those that were there";
  }
  EXPECT_EQ(guessed(unsigned_signal("SPEED")), "");
  EXPECT_EQ(guessed(" SG_ COUNTER : 8|8@1- (1,0) [0|0] \"\" X\n"), "") << "signed";
  EXPECT_EQ(guessed(" SG_ COUNTER : 8|32@1+ (1,0) [0|0] \"\" X\nSIG_VALTYPE_ 1 COUNTER : 1;"), "")
      << "no integer";
  const std::string of_two = " SG_ CNT m2 : 8|8@1+ (1,0) [0|0] \"\" X\n";
  EXPECT_EQ(guessed(of_two, " m2"), "CNT");
  EXPECT_EQ(guessed(of_two, " m3"), "");
  EXPECT_EQ(guessed(of_two), "") << "it is not in every frame";
  EXPECT_EQ(guessed(unsigned_signal("CNT"), " m3"), "CNT") << "it is";
  const auto own = message_of(unsigned_signal("COUNTER_ACCEL"));
  EXPECT_EQ(guess_counter(own.value().messages[0], own.value().messages[0].signals[0]), nullptr)
      << "not itself";
}

TEST(DbcRules, AMultiplexedSignalNeedsItsMultiplexor) {
  EXPECT_THAT(channel_from(message_of(" SG_ S m1 : 0|8@1- (1,0) [0|0] \"g\" X").value(), "A.S", "")
                  .error_text(),
              HasSubstr("no multiplexor (M) in its message, expected one"));
  const auto dbc = message_of(
      " SG_ S m65535 : 8|8@1- (1,0) [0|0] \"g\" X\n SG_ P M : 0|8@1+ (1,0) [0|0] \"\" X\n"
      " SG_ Q M : 0|8@1- (1,0) [0|0] \"g\" X");
  EXPECT_EQ(channel_from(dbc.value(), "A.S", "").value().multiplexor_value, 65535U);
  EXPECT_FALSE(channel_from(dbc.value(), "A.Q", "").value().multiplexed)
      << "a multiplexor is in every frame";
}

TEST(DbcRules, ReadsWhatToolsWrite) {
  const auto layout_of = [](const std::string& line) {
    const auto dbc = message_of(line);
    EXPECT_TRUE(dbc.ok()) << line << dbc.error_text();
    return dbc.ok() ? dbc.value().messages.at(0).signals.at(0).layout : SignalLayout{};
  };
  EXPECT_EQ(layout_of("SG_ S:0|8@1+(+1.5E-2,-.5)[+0|-0]\"\"X").scale, 0.015) << "without blanks";
  EXPECT_EQ(layout_of("SG_ S:0|8@1+(+1.5E-2,-.5)[+0|-0]\"\"X").offset, -0.5);
  EXPECT_EQ(layout_of("\t SG_  S  :  3 | 8 @ 0 -  ( 2 , 1 )  [ 0 | 9 ]  \"\" X\r").maximum, 9.0);
  EXPECT_FALSE(message_of(" SG_ S : 0|8@1+ (+-1,0) [0|0] \"\" X").ok());
  EXPECT_FALSE(message_of(" SG_ S : 0|256@1+ (1,0) [0|0] \"\" X").ok());
  EXPECT_FALSE(message_of(" SG_ S : 0|8@1+ (1,0) [0|inf] \"\" X").ok());
  EXPECT_FALSE(message_of(" SG_ S : 0|8@1+ (1,0) [0|0] \"g X").ok()) << "an open quote";
  EXPECT_FALSE(message_of("", "BO_ 1 A 8 X").ok()) << "no colon";
  EXPECT_FALSE(message_of("", "BO_ 1 : 8 X").ok()) << "no name";
  EXPECT_FALSE(message_of("", "BO_ 1 A: X").ok()) << "no length";
  for (const char* mark : {"m", "mM", "mx", "m1x", "N", "m-1"})
    EXPECT_FALSE(message_of(fmt::format(" SG_ S {} : 0|8@1+ (1,0) [0|0] \"\" X", mark)).ok())
        << mark;
  const auto marked = parse_dbc(
      "\xEF\xBB\xBF"
      "BO_ 1 A: 8 X",
      "a.dbc");
  EXPECT_TRUE(marked.ok()) << "with a byte order mark, and no end of the last line";
}

// SIG_VALTYPE_ 0 is an integer; it is of one message and one signal.
TEST(DbcRules, AFloatIsOneByItsMessageAndName) {
  const auto is_float = [](const std::string& statement) {
    const auto dbc = message_of(
        " SG_ S : 0|32@1- (1,0) [0|0] \"\" X\n SG_ T : 0|32@1- (1,0) [0|0] "
        "\"\" X\n" +
        statement);
    return std::pair{dbc.value().messages[0].signals[0].is_float,
                     dbc.value().messages[0].signals[1].is_float};
  };
  EXPECT_EQ(is_float("SIG_VALTYPE_ 1 S : 1;"), std::pair(true, false));
  EXPECT_EQ(is_float("SIG_VALTYPE_ 1 T : 2;"), std::pair(false, true));
  EXPECT_EQ(is_float("SIG_VALTYPE_ 1 S : 0;"), std::pair(false, false));
  EXPECT_EQ(is_float("SIG_VALTYPE_ 2 S : 1;"), std::pair(false, false));
  EXPECT_EQ(is_float("SIG_VALTYPE_ 2147483649 S : 1;"), std::pair(false, false)) << "29 bits";
  EXPECT_EQ(is_float("SIG_VALTYPE_"), std::pair(false, false));
  EXPECT_EQ(is_float("SIG_VALTYPE_ 1 S : ;"), std::pair(false, false)) << "without a type";
}

// Quotes that do not close on their line hide what follows until they do.
TEST(DbcRules, TextInQuotesHidesStatements) {
  const auto dbc =
      parse_dbc("BO_ 1 A: 8 X\nCM_ \"begins\nBO_ 2 B: 8 X\nends\";\nBO_ 3 C: 8 X\n", "a.dbc");
  ASSERT_EQ(dbc.value().messages.size(), 2U);
  EXPECT_EQ(dbc.value().messages[1].name, "C");
  EXPECT_THAT(parse_dbc("BO_ 1 A: 8 X\nCM_ \"b\ne\";\nBO_ X\n", "a.dbc").error_text(),
              HasSubstr("a.dbc:4:"));
}

}  // namespace
}  // namespace dampline::drivers

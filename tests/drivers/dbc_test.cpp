// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/dbc/channel.hpp"
#include "drivers/dbc/parse.hpp"
#include "temporary_file.hpp"
#include "tests/shared_data.hpp"

namespace dampline::drivers {
namespace {
using ::testing::HasSubstr;

constexpr std::string_view kSensors = R"(VERSION "x"
NS_ :
	SIG_VALTYPE_
	CM_
BU_: NODE
BO_ 256 FRAME: 4 NODE
 SG_ ACCEL_Z : 0|12@1- (0.05,0) [-102.4|102.35] "m/s^2" LOGGER
 SG_ Frame_Counter : 12|12@1+ (1,0) [0|4095] "" LOGGER

BO_ 2566844926 WHEELSET: 8 NODE
 SG_ MUX M : 7|4@0+ (1,0) [0|15] "" LOGGER
 SG_ ACCEL_A m3 : 15|16@0- (1E-3,+0.5) [0|0] "g" LOGGER
 SG_ ACCEL_B m4 : 15|16@0- (1,0) [0|0] "mg" LOGGER
 SG_ ALIVE_A m3 : 39|8@0+ (1,0) [0|0] "" LOGGER
 SG_ SEQ_B m4 : 47|8@0+ (1,0) [0|0] "" LOGGER
 SG_ DEEP m3M : 31|4@0+ (1,0) [0|0] "" LOGGER
BO_ 300 OTHER: 8 NODE
 SG_ FLOATING : 0|32@1- (1,0) [0|0] "m/s^2" LOGGER
 SG_ SPEED : 32|16@1+ (0.01,0) [0|0] "km/h" LOGGER
 SG_ BEYOND : 60|8@1+ (1,0) [0|0] "m/s^2" LOGGER
 SG_ FLAT : 56|4@1+ (0,0) [0|0] "m/s^2" LOGGER
CM_ BO_ 256 "A comment over two lines,
BO_ 1 that is no message";
VAL_ 300 SPEED 1 "SG_ no" 0 "off" ;
SIG_VALTYPE_ 300 FLOATING : 1;
)";

Dbc sensors() { return parse_dbc(kSensors, "sensors.dbc").value(); }

std::string error_of(std::string_view text) { return parse_dbc(text, "bad.dbc").error_text(); }

TEST(Dbc, ReadsMessagesAndSignals) {
  const Dbc dbc = sensors();
  ASSERT_EQ(dbc.messages.size(), 3U);
  const DbcMessage& frame = dbc.messages[0];
  EXPECT_EQ(frame.name, "FRAME");
  EXPECT_EQ(frame.id, 256U);
  EXPECT_FALSE(frame.extended);
  EXPECT_EQ(frame.length, 4U);
  ASSERT_EQ(frame.signals.size(), 2U);
  const SignalLayout& accel = frame.signals[0].layout;
  EXPECT_EQ(accel.start_bit, 0);
  EXPECT_EQ(accel.length, 12);
  EXPECT_EQ(accel.order, ByteOrder::kIntel);
  EXPECT_TRUE(accel.is_signed);
  EXPECT_EQ(accel.scale, 0.05);
  EXPECT_EQ(accel.minimum, -102.4);
  EXPECT_EQ(accel.maximum, 102.35);
  EXPECT_EQ(frame.signals[0].unit, "m/s^2");
}

TEST(Dbc, ReadsExtendedIdentifiersMotorolaOrderAndMultiplexing) {
  const Dbc dbc = sensors();
  const DbcMessage& wheelset = dbc.messages[1];
  EXPECT_TRUE(wheelset.extended);
  EXPECT_EQ(wheelset.id, 2566844926U - 2147483648U);
  EXPECT_EQ(wheelset.signals[0].multiplexing, Multiplexing::kMultiplexor);
  EXPECT_EQ(wheelset.signals[1].multiplexing, Multiplexing::kMultiplexed);
  EXPECT_EQ(wheelset.signals[1].multiplexor_value, 3U);
  EXPECT_EQ(wheelset.signals[1].layout.order, ByteOrder::kMotorola);
  EXPECT_EQ(wheelset.signals[1].layout.scale, 1e-3);
  EXPECT_EQ(wheelset.signals[1].layout.offset, 0.5);
  EXPECT_EQ(wheelset.signals[5].multiplexing, Multiplexing::kExtended);
}

TEST(Dbc, ReadsTheSharedSampleWithItsMissingSpaces) {
  const auto path = test::shared_data() / "can_log" / "sample_can_spec.dbc";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "measured data not found: " << path;
  const auto dbc = load_dbc(path.string());
  ASSERT_TRUE(dbc.ok()) << dbc.error_text();
  EXPECT_EQ(dbc.value().messages.size(), 8U);
  const auto yaw = find_signal(dbc.value(), "ID_D0.GYRO_YAW");  // SG_ GYRO_YAW: 16|9
  ASSERT_TRUE(yaw.ok()) << yaw.error_text();
  EXPECT_EQ(yaw.value().signal->layout.length, 9);
  EXPECT_EQ(yaw.value().signal->unit, "rad/s");
}

TEST(Dbc, ErrorsNameFileLineWhatWasFoundAndWhatWasExpected) {
  EXPECT_EQ(error_of("BO_ 1 A: 8 X\n SG_ S 0|8@1+ (1,0) [0|0] \"\" X\n"),
            "bad.dbc:2: found \"|8@1+ (1,0) [0|0] \"\" X\", expected M, m<number>, m<number>M or a "
            "colon");
  EXPECT_THAT(error_of("\n\nBO_ X A: 8 X\n"),
              HasSubstr("bad.dbc:3: found \"X A: 8 X\", expected BO_"));
  EXPECT_THAT(error_of("SG_ S : 0|8@1+ (1,0) [0|0] \"\" X\n"),
              HasSubstr("expected a message (BO_) before"));
  EXPECT_THAT(error_of("BO_ 1 A: 8 X\n SG_ S : 0|8@1 (1,0) [0|0] \"\" X\n"),
              HasSubstr("sign + or -"));
  EXPECT_THAT(error_of("BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (1;0) [0|0] \"\" X\n"),
              HasSubstr("(scale,offset)"));
  EXPECT_THAT(error_of("BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (nan,0) [0|0] \"\" X\n"),
              HasSubstr("(scale,offset)"));
  EXPECT_THAT(error_of("BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] m/s X\n"),
              HasSubstr("unit in quotes"));
  EXPECT_THAT(error_of("BO_ 1 A: 8 X\n SG_ S : 0|8@2+ (1,0) [0|0] \"\" X\n"),
              HasSubstr("byte order 0 or 1"));
  EXPECT_THAT(error_of("time_s,force_n\n"),
              HasSubstr("bad.dbc: no message (BO_) found; expected a DBC file"));
}

TEST(Dbc, SaysThatAFileIsNotThereOrEmpty) {
  EXPECT_THAT(load_dbc("/nonexistent/a.dbc").error_text(), HasSubstr("/nonexistent/a.dbc"));
  const test::TemporaryFile empty{""};
  EXPECT_THAT(load_dbc(empty.path()).error_text(), HasSubstr("empty"));
}

TEST(Dbc, RefusesMoreThan64Mib) {
  const test::TemporaryFile file{std::string{kSensors}};
  const auto most = std::uintmax_t{64} * 1024 * 1024;
  std::filesystem::resize_file(file.path(), most + 1);
  EXPECT_THAT(load_dbc(file.path()).error_text(), HasSubstr("larger than 67108864 bytes"));
}

TEST(Dbc, BearsEveryTruncationAndCorruption) {
  for (std::size_t length = 0; length <= kSensors.size(); ++length) {
    static_cast<void>(parse_dbc(kSensors.substr(0, length), "cut.dbc").ok());
    std::string corrupt{kSensors};
    if (length < corrupt.size()) corrupt[length] = static_cast<char>(length * 37);
    static_cast<void>(parse_dbc(corrupt, "corrupt.dbc").ok());
  }
}

TEST(DbcLookup, NamesTheFileAndTheNearestSignals) {
  const auto found = find_signal(sensors(), "FRAME.ACEL_Z");
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.failure().code, Errc::kInvalidConfig);
  EXPECT_THAT(found.error_text(), HasSubstr("sensors.dbc: found no signal \"FRAME.ACEL_Z\""));
  EXPECT_THAT(found.error_text(), HasSubstr("signals: FRAME.ACCEL_Z, "));
}

TEST(DbcChannel, TakesTheCounterInTheSameMessage) {
  const auto channel = channel_from(sensors(), "FRAME.ACCEL_Z", "");
  ASSERT_TRUE(channel.ok()) << channel.error_text();
  EXPECT_EQ(channel.value().id, 256U);
  EXPECT_TRUE(channel.value().has_counter);
  EXPECT_EQ(channel.value().counter.start_bit, 12);
  EXPECT_EQ(channel.value().interface_index, -1);
  EXPECT_FALSE(channel.value().multiplexed);
}

TEST(DbcChannel, TakesTheCounterOfItsMultiplexorValueAndConvertsG) {
  const auto a = channel_from(sensors(), "WHEELSET.ACCEL_A", "");
  ASSERT_TRUE(a.ok()) << a.error_text();
  EXPECT_TRUE(a.value().extended);
  EXPECT_TRUE(a.value().multiplexed);
  EXPECT_EQ(a.value().multiplexor.start_bit, 7);
  EXPECT_EQ(a.value().multiplexor_value, 3U);
  EXPECT_EQ(a.value().counter.start_bit, 39);
  EXPECT_DOUBLE_EQ(a.value().accel.scale, 9.80665e-3);
  EXPECT_DOUBLE_EQ(a.value().accel.offset, 0.5 * 9.80665);
  const auto b = channel_from(sensors(), "WHEELSET.ACCEL_B", "WHEELSET.SEQ_B");
  ASSERT_TRUE(b.ok()) << b.error_text();
  EXPECT_EQ(b.value().counter.start_bit, 47);
  EXPECT_DOUBLE_EQ(b.value().accel.scale, 9.80665e-3);
}

TEST(DbcChannel, RefusesWhatItCannotUseAndSaysWhy) {
  const Dbc dbc = sensors();
  const auto why = [&](const char* accel, const char* counter) {
    return channel_from(dbc, accel, counter).error_text();
  };
  EXPECT_EQ(why("OTHER.FLOATING", ""),
            "sensors.dbc:18: OTHER.FLOATING: found a floating-point signal (SIG_VALTYPE_), "
            "expected an integer");
  EXPECT_THAT(why("OTHER.SPEED", ""), HasSubstr("unit \"km/h\", expected an acceleration"));
  EXPECT_THAT(why("OTHER.BEYOND", ""),
              HasSubstr("found bits in byte 8, expected all within the message's 8 bytes"));
  EXPECT_THAT(why("OTHER.FLAT", ""), HasSubstr("a scale of 0"));
  EXPECT_THAT(why("WHEELSET.DEEP", ""), HasSubstr("extended multiplexing"));
  EXPECT_THAT(why("FRAME.ACCEL_Z", "FRAME.NONE"), HasSubstr("found no signal \"FRAME.NONE\""));
  EXPECT_THAT(why("FRAME.ACCEL_Z", "OTHER.SPEED"), HasSubstr("found a counter in other frames"));
  EXPECT_THAT(why("WHEELSET.ACCEL_A", "WHEELSET.SEQ_B"),
              HasSubstr("found a counter in other frames"));
}

}  // namespace
}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
// Lines of each text format, taken from files of can-utils, python-can and the formats' published
// descriptions, and what is wrong with bad ones.
#include "drivers/record/frame_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "drivers/record/frames.hpp"
#include "tests/drivers/file_frames.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::drivers {
namespace {

using test::FileFrames;
using test::frames_of;
using test::TemporaryFile;
using testing::HasSubstr;

TEST(CandumpScreen, ReadsEveryKindOfFrame) {
  const FileFrames out = frames_of(
      " (1600000001.000300)  can1  TX B E  12345678   [0]  remote request\n"
      " (1600000001.000400)  can1  RX B -       123  [12]  11 22 33 44 55 66 77 88 99 AA BB CC\n"
      " (1600000001.000500)  can0  RX - -  20000004   [8]  00 04 00 00 00 00 00 00   ERRORFRAME\n"
      " (1600000001.000600)  can1  12345678   [2]  11 22   '.\"'\n");
  ASSERT_EQ(out.frames.size(), 4U) << out.error;
  EXPECT_TRUE(out.frames[0].remote && out.frames[0].extended);
  EXPECT_TRUE(out.frames[1].fd);
  EXPECT_EQ(out.frames[1].length, 12);
  EXPECT_EQ(out.frames[1].fd_flags, 1);
  EXPECT_EQ(out.frames[1].data[11], 0xCC);
  EXPECT_TRUE(out.frames[2].error);
  EXPECT_EQ(out.frames[3].id, 0x12345678U);
  EXPECT_EQ(out.frames[3].time_ns, 1'600'000'001'000'600'000);
  EXPECT_THAT(out.interfaces, testing::ElementsAre("can1", "can0"));
}

TEST(AscParser, ReadsEveryKindOfFrame) {
  const FileFrames out = frames_of(
      "date Tue Nov 14 10:13:20.123 pm 2023\r\nbase hex  timestamps absolute\r\n"
      "internal events logged\r\n// a comment\r\nBegin Triggerblock Tue Nov 14 10:13:20 pm 2023\r\n"
      "   0.000000 Start of measurement\r\n"
      "   0.015991 2  18EBFF00x       Rx   d 8 01 A0 0F A6 60 3B D1 40 Length = 273910 BitCount = "
      "141\r\n"
      "   0.016000 1  Statistic: D 0 R 0 XD 0\r\n"
      "   0.017000 1  ErrorFrame\r\n"
      "   0.018000 1  7FF             Tx   r 4\r\n"
      "   0.019000 CANFD   1 Rx        123  Engine_Name                     1 0 9 12 11 22 33 44 "
      "55 "
      "66 77 88 99 AA BB CC   130000  130     3000 0 0 0 0 0\r\n"
      "End TriggerBlock\r\n");
  ASSERT_EQ(out.frames.size(), 4U) << out.error;
  EXPECT_EQ(out.frames[0].id, 0x18EBFF00U);
  EXPECT_TRUE(out.frames[0].extended);
  EXPECT_EQ(out.frames[0].time_ns, 15'991'000);
  EXPECT_EQ(out.frames[0].data[7], 0x40);
  EXPECT_TRUE(out.frames[1].error);
  EXPECT_TRUE(out.frames[2].remote);
  EXPECT_EQ(out.frames[2].length, 4);
  EXPECT_TRUE(out.frames[3].fd);
  EXPECT_EQ(out.frames[3].fd_flags, 1);
  EXPECT_EQ(out.frames[3].length, 12);
  EXPECT_THAT(out.interfaces, testing::ElementsAre("can2", "can1"));
}

TEST(AscParser, KnowsDecimalNumbersAndTimesSinceTheLineBefore) {
  const FileFrames out = frames_of(
      "date Tue Nov 14 22:13:20 2023\nbase dec timestamps relative\n"
      "  1.5 1  291  Rx  d 2 17 255\n  0.25 1  Statistic: D 0\n  0.25 1  291  Rx  d 1 9\n");
  ASSERT_EQ(out.frames.size(), 2U) << out.error;
  EXPECT_EQ(out.frames[0].id, 291U);
  EXPECT_EQ(out.frames[0].data[1], 255);
  EXPECT_EQ(out.frames[1].time_ns, 2'000'000'000);
}

TEST(TrcParser, ReadsEveryVersion) {
  const FileFrames v10 = frames_of(
      ";   Start time: 01.01.2020\n     1)   1059 0300 2 01 02\n     2) 1060 FFFFFFFF 4 00 00 00 "
      "08\n");
  ASSERT_EQ(v10.frames.size(), 1U) << v10.error;
  EXPECT_EQ(v10.frames[0].time_ns, 1'059'000'000);
  const FileFrames v11 = frames_of(
      ";$FILEVERSION=1.1\n 1) 1059.9 Rx 0300 7 00 00 00 00 04 00 00\n"
      " 2) 1060.0 Warng FFFFFFFF 4 00 00 00 08 BUSHEAVY\n 3) 1283.2 Tx 18EFC034 2 A0 04\n"
      " 4) 1300.0 Rx 0301 3 RTR\n");
  ASSERT_EQ(v11.frames.size(), 3U) << v11.error;
  EXPECT_EQ(v11.frames[0].time_ns, 1'059'900'000);
  EXPECT_TRUE(v11.frames[1].extended);
  EXPECT_TRUE(v11.frames[2].remote);
  const FileFrames v13 =
      frames_of(";$FILEVERSION=1.3\n 1) 17535.4 2 Tx 00000100 - 8 00 00 00 00 00 00 00 01\n");
  ASSERT_EQ(v13.frames.size(), 1U) << v13.error;
  EXPECT_EQ(v13.interfaces.at(0), "can2");
  const FileFrames v20 = frames_of(
      ";$FILEVERSION=2.0\n;$COLUMNS=N,O,T,I,d,l,D\n 1 1059.900 DT 0300 Rx 2 01 02\n"
      " 2 1060.100 FB 18EFC034 Rx 12 00 01 02 03 04 05 06 07 08 09 0A 0B\n"
      " 3 1061.000 ST    Rx    00 00 00 00\n 4 1062.345 RR 0100 Tx 3\n");
  ASSERT_EQ(v20.frames.size(), 3U) << v20.error;
  EXPECT_TRUE(v20.frames[1].fd);
  EXPECT_EQ(v20.frames[1].length, 12);
  EXPECT_EQ(v20.frames[2].time_ns, 1'062'345'000);
  const FileFrames v21 = frames_of(
      ";$FILEVERSION=2.1\n;$COLUMNS=N,O,T,B,I,d,R,L,D\n"
      " 1 1.5 FD 3 0300 Rx - 9 00 01 02 03 04 05 06 07 08 09 0A 0B\n");
  ASSERT_EQ(v21.frames.size(), 1U) << v21.error;
  EXPECT_EQ(v21.frames[0].length, 12);
  EXPECT_THAT(frames_of(";$FILEVERSION=3.0\n 1 2 3\n").error, HasSubstr(":1: a TRC version"));
}

TEST(FrameLines, NamesFileLineAndColumnOfABadLine) {
  const std::string text =
      ";$FILEVERSION=1.1\n 1) 10.0 Rx 0300 2 00 0G\n 2) 11.0 Rx 0300 2 00 01\n";
  const FileFrames stopped = frames_of(text);
  EXPECT_EQ(stopped.reason, Errc::kMalformed);
  EXPECT_THAT(stopped.error, HasSubstr(":2:23: found \"0G\", expected a byte"));
  const FileFrames skipped = frames_of(text, true);
  EXPECT_EQ(skipped.frames.size(), 1U);
  EXPECT_EQ(skipped.health.malformed, 1U);
}

TEST(FrameLines, HoldsATimeThatGoesBackALittleAndRefusesMore) {
  const std::string head = ";$FILEVERSION=1.1\n 1) 5000.0 Rx 0300 0\n";
  const FileFrames held = frames_of(head + " 2) 4999.0 Rx 0300 0\n");
  EXPECT_EQ(held.health.reordered, 1U);
  EXPECT_EQ(held.frames.at(1).time_ns, 5'000'000'000);
  EXPECT_THAT(frames_of(head + " 2) 3999.0 Rx 0300 0\n").error, HasSubstr("does not go back"));
}

TEST(FrameLines, HoldsATimeThatGoesBackByLessThanASecond) {
  const std::string head = ";$FILEVERSION=1.1\n 1) 5000.0 Rx 0300 0\n 2) 5000.0 Rx 0300 0\n";
  EXPECT_EQ(frames_of(head).health.reordered, 0U);
  const FileFrames held = frames_of(head + " 3) 4000.001 Rx 0300 0\n 4) 4000.001 Rx 0300 0\n");
  EXPECT_EQ(held.health.reordered, 2U);
  ASSERT_EQ(held.frames.size(), 4U) << held.error;
  EXPECT_EQ(held.frames[3].time_ns, 5'000'000'000);
  EXPECT_THAT(frames_of(head + " 3) 4000.0 Rx 0300 0\n").error, HasSubstr("does not go back"));
}

TEST(FrameLines, TimesSinceTheLineBeforeStopAtTheEndOfTheClock) {
  const FileFrames out = frames_of(
      "base hex timestamps relative\n 9000000000.5 1 1 Rx d 0\n 9000000000.5 1 1 Rx d 0\n"
      " 0.5 1 1 Rx d 0\n");
  ASSERT_EQ(out.frames.size(), 3U) << out.error;
  EXPECT_EQ(out.frames[0].time_ns, 9'000'000'000'500'000'000);
  EXPECT_EQ(out.frames[1].time_ns, std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(out.frames[2].time_ns, std::numeric_limits<std::int64_t>::max());
}

TEST(FrameLines, GivesEachFrameItsInterfaceOrOnlyThoseThatWereAskedFor) {
  const std::string text =
      ";$FILEVERSION=1.2\n 1) 1.0 3 Rx 0301 0\n 2) 2.0 7 Rx 0302 0\n 3) 3.0 3 Rx 0303 0\n";
  const FileFrames all = frames_of(text);
  EXPECT_THAT(all.interfaces, testing::ElementsAre("can3", "can7"));
  ASSERT_EQ(all.frames.size(), 3U) << all.error;
  for (const auto& [frame, interface] : {std::pair{0U, 0}, {1U, 1}, {2U, 0}})
    EXPECT_EQ(all.frames[frame].interface_index, interface) << frame;
  EXPECT_EQ(all.health.ignored, 1U) << "the line of the version";
  const TemporaryFile file{text};
  const FileFrames some =
      frames_of(open_frames({.path = file.path(), .interfaces = {"can7", "can9"}}));
  ASSERT_EQ(some.frames.size(), 1U) << some.error;
  EXPECT_EQ(some.frames[0].id, 0x302U);
  EXPECT_EQ(some.health.ignored, 3U);
  EXPECT_EQ(some.health.frames, 1U);
  const FileFrames none = frames_of(open_frames({.path = file.path(), .interfaces = {"can9"}}));
  EXPECT_EQ(none.reason, Errc::kEndOfStream) << "they are there, but nobody asks for them";
}

TEST(FrameLines, ALastLineWithoutItsEndIsCutOff) {
  const FileFrames out = frames_of(";$FILEVERSION=1.1\n 1) 5.0 Rx 0300 1 11\n 2) 6.0 Rx 0300 2 0");
  EXPECT_EQ(out.frames.size(), 1U);
  EXPECT_TRUE(out.health.truncated);
  EXPECT_EQ(out.reason, Errc::kEndOfStream);
}

}  // namespace
}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
// Files that python-can wrote, which are also the fuzzers' corpus (behind one byte of theirs).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "drivers/blf/source.hpp"
#include "drivers/record/frames.hpp"
#include "tests/drivers/file_frames.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::drivers {
namespace {

using test::content_of;
using test::FileFrames;
using test::frames_of;
using test::TemporaryFile;
using testing::HasSubstr;

std::string written(const std::string& name) {
  return content_of(std::string{DAMPLINE_SOURCE_DIR} + "/tests/fuzz/corpus/blf/" + name).substr(1);
}

TEST(BlfSource, ReadsEveryKindOfFrame) {
  for (const char* name : {"zlib", "plain"}) {
    const FileFrames out = frames_of(written(name));
    ASSERT_EQ(out.frames.size(), 5U) << name << out.error;
    EXPECT_EQ(out.reason, Errc::kEndOfStream);
    EXPECT_FALSE(out.health.truncated);
    EXPECT_EQ(out.frames[0].id, 0x123U);
    EXPECT_EQ(out.frames[0].data[2], 3);
    EXPECT_TRUE(out.frames[1].extended);
    EXPECT_EQ(out.frames[1].id, 0x18EBFF00U);
    EXPECT_EQ(out.frames[1].interface_index, 1);
    EXPECT_EQ(out.frames[1].time_ns - out.frames[0].time_ns, 500'000'000);
    EXPECT_TRUE(out.frames[2].remote);
    EXPECT_TRUE(out.frames[3].fd);
    EXPECT_EQ(out.frames[3].fd_flags, 1);
    EXPECT_EQ(out.frames[3].length, 12);
    EXPECT_EQ(out.frames[3].data[11], 11);
    EXPECT_TRUE(out.frames[4].error);
  }
}

TEST(BlfSource, CutOffAnywhereItGivesWhatIsThere) {
  for (const char* name : {"zlib", "plain"}) {
    const std::string whole = written(name);
    std::size_t most = 0;
    for (std::size_t size = 80; size < whole.size(); ++size) {
      const FileFrames out = frames_of(whole.substr(0, size));
      EXPECT_NE(out.reason, Errc::kIo);
      EXPECT_GE(out.frames.size(), most) << size;
      most = out.frames.size();
      EXPECT_TRUE(out.health.truncated || out.frames.size() == 5 || size <= 144) << size;
    }
    EXPECT_GE(most, 4U);
  }
}

TEST(BlfSource, NamesTheContainerThatIsDamaged) {
  std::string bytes = written("zlib");
  for (std::size_t i = 190; i < 200; ++i) bytes[i] = '\xFF';
  const FileFrames stopped = frames_of(bytes);
  EXPECT_EQ(stopped.reason, Errc::kMalformed);
  EXPECT_THAT(stopped.error, HasSubstr("byte 144"));
  const FileFrames skipped = frames_of(bytes, true);
  EXPECT_EQ(skipped.reason, Errc::kEndOfStream);
  EXPECT_GE(skipped.health.malformed, 1U);
}

TEST(BlfSource, GoesOnBehindAnObjectThatIsNone) {
  std::string bytes = written("plain");
  const std::size_t second = bytes.find("LOBJ", bytes.find("LOBJ", 180) + 1);
  bytes[second] = 'X';
  EXPECT_THAT(frames_of(bytes).error, HasSubstr("expected an object (LOBJ)"));
  const FileFrames skipped = frames_of(bytes, true);
  EXPECT_EQ(skipped.frames.size(), 4U);
  EXPECT_EQ(skipped.health.malformed, 1U);
}

}  // namespace
}  // namespace dampline::drivers

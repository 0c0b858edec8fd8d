// SPDX-License-Identifier: MIT
// Files that python-can wrote, which are also the fuzzers' corpus (behind one byte of theirs).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "drivers/blf/source.hpp"
#include "drivers/record/frames.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::drivers {
namespace {

using test::content_of;
using test::TemporaryFile;
using testing::HasSubstr;

std::string written(const std::string& name) {
  return content_of(std::string{DAMPLINE_SOURCE_DIR} + "/tests/fuzz/corpus/blf/" + name).substr(1);
}

struct BlfFrames {
  std::vector<CanFrame> frames;
  hal::SourceHealth health;
  std::string error;
  Errc reason{};
};
BlfFrames blf_frames(const std::string& bytes, bool skip = false) {
  const TemporaryFile file{bytes};
  auto source = open_frames({.path = file.path(), .skip_bad_lines = skip});
  if (!source) return {{}, {}, source.error_text(), source.failure().code};
  BlfFrames out;
  std::array<CanFrame, 2> part;
  auto read = source.value()->read(part);
  for (; read; read = source.value()->read(part))
    out.frames.insert(out.frames.end(), part.begin(),
                      part.begin() + static_cast<std::ptrdiff_t>(read.value()));
  out.reason = read.error();
  out.health = source.value()->health();
  out.error = source.value()->error_text();
  return out;
}

TEST(BlfSource, ReadsEveryKindOfFrame) {
  for (const char* name : {"zlib", "plain"}) {
    const BlfFrames out = blf_frames(written(name));
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
      const BlfFrames out = blf_frames(whole.substr(0, size));
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
  const BlfFrames stopped = blf_frames(bytes);
  EXPECT_EQ(stopped.reason, Errc::kMalformed);
  EXPECT_THAT(stopped.error, HasSubstr("byte 144"));
  const BlfFrames skipped = blf_frames(bytes, true);
  EXPECT_EQ(skipped.reason, Errc::kEndOfStream);
  EXPECT_GE(skipped.health.malformed, 1U);
}

TEST(BlfSource, GoesOnBehindAnObjectThatIsNone) {
  std::string bytes = written("plain");
  const std::size_t second = bytes.find("LOBJ", bytes.find("LOBJ", 180) + 1);
  bytes[second] = 'X';
  EXPECT_THAT(blf_frames(bytes).error, HasSubstr("expected an object (LOBJ)"));
  const BlfFrames skipped = blf_frames(bytes, true);
  EXPECT_EQ(skipped.frames.size(), 4U);
  EXPECT_EQ(skipped.health.malformed, 1U);
}

}  // namespace
}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
// The same frames in every format give the same bytes of state.dls. The files are written by
// can-utils (log2asc, log2long) and python3-can, never by this project; but for MDF4, which no
// program of Debian writes: tests/mdf4.py does, by the format's description.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/app/formats.hpp"

namespace dampline::app {
namespace {

using testing::HasSubstr;

class FrameFormats : public FormatTest {
 protected:
  void SetUp() override {
    ASSERT_EQ(program_.run("simulate --duration 40 --seed 3 --quiet --out a.log").code, 0);
    expected_ = state_of("a.log");
    ASSERT_GT(expected_.size(), 10000U);
  }
  StateBytes expected_;
};

TEST_F(FrameFormats, CandumpOnTheScreenWithAnyTimes) {
  if (!shell("log2long < a.log > absolute.txt")) GTEST_SKIP() << "can-utils is not installed";
  EXPECT_EQ(state_of("absolute.txt"), expected_);
  // The other times as candump.c prints them: "(%03llu.%06llu)", and the date in UTC.
  ASSERT_TRUE(python(R"(
import re, datetime
lines = open('absolute.txt').read().splitlines()
times = [int(re.match(r'\((\d+)\.(\d+)\)', l).expand(r'\1\2')) for l in lines]
rest = [l[l.index(')') + 1:] for l in lines]
short = lambda us: '(%03d.%06d)' % divmod(us, 1000000)
date = lambda us: datetime.datetime.utcfromtimestamp(us // 1000000).strftime('(%Y-%m-%d %H:%M:%S') + '.%06d)' % (us % 1000000)
extra = lambda r: r.replace('  can0  ', '  can0  RX - -  ', 1)
write = lambda name, rows: open(name, 'w').write(''.join(r + '\n' for r in rows))
write('zero.txt', [' ' + short(t - times[0]) + r for t, r in zip(times, rest)])
write('steps.txt', [' ' + short(t - b) + extra(r) for t, b, r in zip(times, times[:1] + times, rest)])
write('date.txt', [' ' + date(t) + r for t, r in zip(times, rest)])
write('none.txt', rest)
)"));
  EXPECT_EQ(state_of("zero.txt"), expected_);
  EXPECT_EQ(state_of("steps.txt"), expected_);
  EXPECT_EQ(state_of("-", "cat steps.txt |"), expected_) << "the differences are seen in a pipe";
  EXPECT_EQ(state_of("date.txt"), expected_);
  EXPECT_EQ(state_of("none.txt").size(), expected_.size());
  EXPECT_THAT(program_.read("run/parameters.json"), HasSubstr("has no times"));
}

TEST_F(FrameFormats, CompressedAndPiped) {
  ASSERT_TRUE(shell("gzip -k a.log"));
  EXPECT_EQ(state_of("a.log.gz"), expected_);
  EXPECT_EQ(state_of("-", "cat a.log.gz |"), expected_);
  EXPECT_EQ(state_of("/dev/stdin", "cat a.log.gz |"), expected_);
  if (!shell("zstd -q a.log")) GTEST_SKIP() << "zstd is not installed";
  EXPECT_EQ(state_of("a.log.zst"), expected_);
}

TEST_F(FrameFormats, VectorAscOfCanUtils) {
  if (!shell("log2asc -I a.log can0 > a.asc")) GTEST_SKIP() << "can-utils is not installed";
  EXPECT_EQ(state_of("a.asc"), expected_);
  ASSERT_TRUE(shell("log2asc -f -n -I a.log can0 > f.asc"));
  EXPECT_EQ(state_of("f.asc"), expected_) << "classic frames in CANFD lines, \\r\\n";
}

TEST_F(FrameFormats, VectorAscAndPeakTrcOfPythonCan) {
  if (!python(R"(
import can
from can.io.trc import TRCFileVersion
frames = list(can.CanutilsLogReader('a.log'))
old = can.TRCWriter('old.trc')
old.file_version = TRCFileVersion.V1_0
for writer in can.ASCWriter('a.asc'), can.TRCWriter('a.trc'), old:
    for frame in frames: writer(frame)
    writer.stop()
)"))
    GTEST_SKIP() << "python3-can is not installed";
  EXPECT_EQ(state_of("a.asc"), expected_);
  EXPECT_EQ(state_of("a.trc"), expected_);
  EXPECT_EQ(state_of("old.trc").size(), expected_.size())
      << "whole ms: other times, not other bits";
}

/// Read by python-can, whose times are numbers in floating point, and by the program.
TEST_F(FrameFormats, VectorBlfOfPythonCan) {
  if (!python(R"(
import can
frames = list(can.CanutilsLogReader('a.log'))
for level in 0, 9:
    writer = can.BLFWriter('a%d.blf' % level, compression_level=level)
    for frame in frames: writer(frame)
    writer.stop()
first = None
with open('back.log', 'w') as out:
    for frame in can.BLFReader('a9.blf'):
        first = frame.timestamp if first is None else first
        out.write('(%.9f) can0 %03X#%s\n' % (frame.timestamp - first + 1, frame.arbitration_id, frame.data.hex()))
)"))
    GTEST_SKIP() << "python3-can is not installed";
  const StateBytes state = state_of("a9.blf");
  EXPECT_EQ(state.size(), expected_.size());
  EXPECT_EQ(state_of("a0.blf"), state);
  EXPECT_EQ(state_of("back.log"), state);
  ASSERT_TRUE(shell("gzip -k a9.blf"));
  EXPECT_EQ(state_of("a9.blf.gz"), state);
}

using FrameFormatsNightly = FrameFormats;

TEST_F(FrameFormatsNightly, Mdf4InEveryLayout) {
  ASSERT_TRUE(python(R"(
import sys
sys.path.insert(0, ')" DAMPLINE_SOURCE_DIR R"(/tests')
import mdf4
frames, start = mdf4.read_candump('a.log')
for i, (sort, variable, deflate, pieces) in enumerate([
        (False, None, None, None), (True, 'data', None, None), (True, 'data', 'plain', 7),
        (False, 'records', 'plain', 7), (False, 'data', 'transposed', 7), (True, None, 'transposed', None)]):
    mdf4.write_frames('m%d.mf4' % i, frames, start, sort=sort, variable=variable, deflate=deflate, pieces=pieces)
mdf4.write_frames('m_unfinished.mf4', frames, start, variable='records', lacks=0x25)
mdf4.write_frames('m_real.mf4', frames, start, time='real', id_bytes=4)
)")) << program_.read(".shell");
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator{program_.path("")}) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".mf4") continue;
    ++files;
    EXPECT_EQ(state_of(name), expected_) << name;
  }
  EXPECT_EQ(files, 8);
  EXPECT_EQ(state_of("-", "cat m_real.mf4 |"), expected_);
  ASSERT_TRUE(shell("gzip -k m_real.mf4"));
  EXPECT_EQ(state_of("m_real.mf4.gz"), expected_);
}

}  // namespace
}  // namespace dampline::app

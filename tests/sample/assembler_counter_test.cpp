// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <random>

#include "dampline/sample/assembler.hpp"
#include "frame_maker.hpp"

namespace dampline {
namespace {

using test::assemble;
using test::Nodes;
using test::run;
using test::sort_by_time;
using test::wrong_samples;

class AssemblerForEachCounter : public ::testing::TestWithParam<unsigned> {
 protected:
  Nodes nodes_{.counter_bits = GetParam()};
  SampleAssembler assembler_{nodes_.config()};
};

TEST_P(AssemblerForEachCounter, DeliversEverySampleOfACleanRun) {
  const auto samples = assemble(assembler_, run(nodes_, 1000, 6000));
  ASSERT_EQ(samples.size(), 5000U);
  EXPECT_EQ(wrong_samples(samples, 1000), 0);
  EXPECT_EQ(samples.back().tick - samples.front().tick, 4999);
  EXPECT_EQ(samples[7].time_ns, nodes_.time_of(1007));
  EXPECT_EQ(assembler_.counts().samples, 5000U);
  EXPECT_EQ(assembler_.counts().incomplete, 0U);
  for (const ChannelCounts& channel : assembler_.counts().channels) EXPECT_EQ(channel.gaps, 0U);
}

TEST_P(AssemblerForEachCounter, JumpsTheTickOverAGapOfAllChannels) {
  auto frames = run(nodes_, 0, 1000);
  const auto after = run(nodes_, 1700, 3000);
  frames.insert(frames.end(), after.begin(), after.end());
  const auto samples = assemble(assembler_, frames);
  ASSERT_EQ(samples.size(), 2300U);
  EXPECT_EQ(wrong_samples(samples, 0), 0);
  EXPECT_EQ(samples[1000].tick - samples[999].tick, 701);
  const AssemblerCounts counts = assembler_.counts();
  for (std::size_t c = 0; c < kChannels; ++c) {
    const ChannelCounts& channel = counts.channels[c];
    EXPECT_EQ(channel.gaps, 1U);
    EXPECT_EQ(channel.lost, 700U);
  }
}

TEST_P(AssemblerForEachCounter, LosesOnlyTheInstantsOfLostFrames) {
  std::mt19937 random{GetParam() + 5};
  std::vector<CanFrame> frames;
  std::vector<bool> whole(20000, true);
  std::uint64_t partial = 0;  // instants that kept one or two of their three frames
  for (std::int64_t tick = 0; tick < 20000; ++tick) {
    std::size_t kept = 0;
    for (std::size_t c = 0; c < kChannels; ++c) {
      // The first and the last instant are whole, so that it is known what is a gap.
      if (random() % 100 < 5 && tick > 0 && tick < 19999) continue;
      frames.push_back(nodes_.frame(c, tick));
      ++kept;
    }
    whole[static_cast<std::size_t>(tick)] = kept == kChannels;
    if (kept == 1 || kept == 2) ++partial;
  }
  const auto samples = assemble(assembler_, frames);
  EXPECT_EQ(static_cast<std::ptrdiff_t>(samples.size()),
            std::count(whole.begin(), whole.end(), true));
  EXPECT_EQ(wrong_samples(samples, 0), 0);
  EXPECT_EQ(assembler_.counts().incomplete, partial);
  const AssemblerCounts counts = assembler_.counts();
  for (std::size_t c = 0; c < kChannels; ++c) {
    const ChannelCounts& channel = counts.channels[c];
    EXPECT_EQ(channel.readings + channel.lost, 20000U);
  }
}

TEST_P(AssemblerForEachCounter, IgnoresARepeatedFrame) {
  std::vector<CanFrame> frames;
  for (const CanFrame& frame : run(nodes_, 0, 2000)) {
    frames.push_back(frame);
    if (frames.size() % 10 == 0) frames.push_back(frame);
  }
  const auto samples = assemble(assembler_, frames);
  EXPECT_EQ(samples.size(), 2000U);
  EXPECT_EQ(wrong_samples(samples, 0), 0);
  std::uint64_t repeated = 0;
  for (const ChannelCounts& channel : assembler_.counts().channels) repeated += channel.repeated;
  EXPECT_EQ(repeated, frames.size() - 6000U);
}

TEST_P(AssemblerForEachCounter, BearsALateFrameWithWhichTheNextOnesCatchUp) {
  std::vector<CanFrame> frames;
  for (std::int64_t tick = 0; tick < 5000; ++tick) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      // Every 97th frame is 2.3 periods late, and the two behind it wait in the same queue.
      const std::int64_t phase = (tick + 31 * static_cast<std::int64_t>(c)) % 97;
      const double late = tick > 20 && phase < 3 ? 2.3 - static_cast<double>(phase) * 0.95 : 0.0;
      frames.push_back(
          nodes_.frame(c, tick, static_cast<std::int64_t>(late * 1e9 / nodes_.rate_hz)));
    }
  }
  sort_by_time(frames);
  const auto samples = assemble(assembler_, frames);
  EXPECT_EQ(samples.size(), 5000U);
  EXPECT_EQ(wrong_samples(samples, 0), 0);
}

TEST_P(AssemblerForEachCounter, BearsJitterOfTheMeasuredLog) {
  std::mt19937 random{7};
  std::uniform_real_distribution<double> jitter{-0.05, 0.065};  // 19.0 ... 21.3 ms at 50 Hz
  std::vector<CanFrame> frames;
  for (std::int64_t tick = 0; tick < 20000; ++tick) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      frames.push_back(
          nodes_.frame(c, tick, static_cast<std::int64_t>(jitter(random) * 1e9 / nodes_.rate_hz)));
    }
  }
  sort_by_time(frames);
  const auto samples = assemble(assembler_, frames);
  EXPECT_EQ(samples.size(), 20000U);
  EXPECT_EQ(wrong_samples(samples, 0), 0);
}

TEST_P(AssemblerForEachCounter, FollowsARateThatIsNotQuiteTheNominalOne) {
  AssemblerConfig config = nodes_.config();
  config.sample_rate_hz = 303.0;  // one per cent off
  SampleAssembler assembler{config};
  const auto samples = assemble(assembler, run(nodes_, 0, 30000));
  EXPECT_EQ(samples.size(), 30000U);
  EXPECT_EQ(wrong_samples(samples, 0), 0);
  EXPECT_NEAR(assembler.measured_rate().rate_hz, 300.0, 1e-6);
}

TEST_P(AssemblerForEachCounter, AlignsAnewAfterALongPause) {
  auto frames = run(nodes_, 0, 1000);
  const auto after = run(nodes_, 1'000'000, 1'001'000);
  frames.insert(frames.end(), after.begin(), after.end());
  const auto samples = assemble(assembler_, frames);
  ASSERT_EQ(samples.size(), 2000U);
  const std::vector<Sample> second{samples.begin() + 1000, samples.end()};
  EXPECT_EQ(wrong_samples(second, 1'000'000), 0);
  EXPECT_NEAR(static_cast<double>(samples[1000].tick - samples[999].tick), 999'001.0, 10.0);
  EXPECT_EQ(assembler_.counts().restarts, 1U);
}

TEST_P(AssemblerForEachCounter, BringsNodesTogetherThatStartedAtDifferentTimes) {
  std::vector<CanFrame> frames;
  for (const CanFrame& frame : run(nodes_, 0, 2000)) {
    const std::int64_t start_ns = nodes_.time_of(frame.id == 0x101   ? 340
                                                 : frame.id == 0x102 ? 5
                                                                     : 0);
    if (frame.time_ns >= start_ns) frames.push_back(frame);
  }
  const auto samples = assemble(assembler_, frames);
  EXPECT_EQ(samples.size(), 1660U);
  EXPECT_EQ(wrong_samples(samples, 340), 0);
}

TEST_P(AssemblerForEachCounter, KnowsTheTrueRateWhenAGapComes) {
  AssemblerConfig config = nodes_.config();
  config.sample_rate_hz = 303.0;  // over 900 lost samples the nominal rate would be off by nine
  SampleAssembler assembler{config};
  auto frames = run(nodes_, 0, 3000);
  const auto after = run(nodes_, 3900, 6000);
  frames.insert(frames.end(), after.begin(), after.end());
  const auto samples = assemble(assembler, frames);
  ASSERT_EQ(samples.size(), 5100U);
  EXPECT_EQ(wrong_samples(samples, 0), 0);
}

// So that a wrong declaration is told, and not a car without sensors.
TEST(AssemblerCounter, FollowsRatesFarFromTheDeclaredOne) {
  for (const unsigned bits : {8U, 16U, 48U}) {
    for (const double declared_hz : {152.0, 205.0, 440.0, 590.0}) {
      const Nodes nodes{.counter_bits = bits};
      AssemblerConfig config = nodes.config();
      config.sample_rate_hz = declared_hz;
      SampleAssembler assembler{config};
      const auto samples = assemble(assembler, run(nodes, 0, 6000));
      EXPECT_GE(samples.size(), 2500U) << bits << " bits, " << declared_hz;
      EXPECT_NEAR(assembler.measured_rate().rate_hz, 300.0, 1e-3)
          << bits << " bits, " << declared_hz;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(CounterBits, AssemblerForEachCounter,
                         ::testing::Values(0U, 4U, 8U, 16U, 48U));

}  // namespace
}  // namespace dampline

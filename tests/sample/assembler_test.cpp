// SPDX-License-Identifier: MIT
#include "dampline/sample/assembler.hpp"

#include <gtest/gtest.h>

#include <random>

#include "frame_maker.hpp"

namespace dampline {
namespace {

using test::assemble;
using test::Nodes;
using test::run;
using test::sort_by_time;
using test::wrong_samples;

TEST(Assembler, SortsSwappedFrames) {
  const Nodes nodes;
  SampleAssembler assembler{nodes.config()};
  auto frames = run(nodes, 0, 3000);
  for (std::size_t i = 300; i + 3 < frames.size(); i += 100) {
    std::swap(frames[i], frames[i + 3]);  // two frames of one channel
    std::swap(frames[i].time_ns, frames[i + 3].time_ns);
  }
  const auto samples = assemble(assembler, frames);
  EXPECT_EQ(samples.size(), 3000U);
  EXPECT_EQ(wrong_samples(samples, 0), 0);
  std::uint64_t late = 0;
  for (const ChannelCounts& channel : assembler.counts().channels) late += channel.late;
  EXPECT_EQ(late, 87U);
}

TEST(Assembler, IsIndifferentToSwapsOfTwoChannels) {
  const Nodes nodes;
  SampleAssembler assembler{nodes.config()};
  auto frames = run(nodes, 0, 300);
  for (std::size_t i = 0; i + 1 < frames.size();
       i += i % 10 == 0 ? 5U : 7U) {  // also across instants
    std::swap(frames[i], frames[i + 1]);
    std::swap(frames[i].time_ns, frames[i + 1].time_ns);
  }
  EXPECT_EQ(wrong_samples(assemble(assembler, frames), 0), 0);
  EXPECT_EQ(assembler.counts().samples, 300U);
}

TEST(Assembler, DropsAFrameThatCameTooLateAndCountsIt) {
  const Nodes nodes;
  SampleAssembler assembler{nodes.config()};
  auto frames = run(nodes, 0, 300);
  const CanFrame lost = frames[301];  // channel 1, tick 100
  frames.erase(frames.begin() + 301);
  CanFrame late = lost;
  late.time_ns = frames[380].time_ns;
  frames.insert(frames.begin() + 381, late);
  const auto samples = assemble(assembler, frames);
  EXPECT_EQ(samples.size(), 299U);
  EXPECT_EQ(wrong_samples(samples, 0), 0);
  EXPECT_EQ(assembler.counts().incomplete, 1U);
  EXPECT_EQ(assembler.counts().channels[1].late, 1U);
}

TEST(Assembler, HandsOutAShortHoleAndDropsALongOne) {
  const Nodes nodes;
  AssemblerConfig config = nodes.config();
  config.most_missing = 3;
  SampleAssembler assembler{config};
  auto frames = run(nodes, 0, 300);
  const auto is_lost = [&](const CanFrame& frame) {
    const auto at = [&](std::size_t c, std::int64_t first, std::int64_t last) {
      return frame.id == 0x100 + c && frame.time_ns >= nodes.frame(c, first).time_ns &&
             frame.time_ns <= nodes.frame(c, last).time_ns;
    };
    return at(1, 100, 102) || at(0, 150, 150) || at(2, 200, 203);
  };
  const auto sent = frames.size();
  std::erase_if(frames, is_lost);
  const auto samples = assemble(assembler, frames);
  EXPECT_EQ(samples.size(), 296U);  // four in a row are too many
  std::size_t holes = 0;
  for (const Sample& sample : samples) {
    const auto missing = std::count_if(sample.accel_mps2.begin(), sample.accel_mps2.end(),
                                       [](double a) { return std::isnan(a); });
    EXPECT_EQ(missing, sample.lost ? 1 : 0);
    holes += sample.lost ? 1U : 0U;
  }
  EXPECT_EQ(holes, 4U);
  EXPECT_EQ(assembler.counts().incomplete, 8U);
  const FrameLedger ledger = ledger_of(assembler.counts(), 0);
  EXPECT_EQ(ledger.sent, sent);
  EXPECT_EQ(ledger.processed, 3U * 292U + 2U * 4U);
  EXPECT_EQ(ledger.without_partner, 2U * 4U);
}

TEST(Assembler, ResolvesAGapOfManyWrapsByTime) {
  const Nodes nodes{.counter_bits = 4};
  SampleAssembler assembler{nodes.config()};
  auto frames = run(nodes, 0, 600);
  const auto after = run(nodes, 600 + 16 * 40 + 5, 2000);
  frames.insert(frames.end(), after.begin(), after.end());
  const auto samples = assemble(assembler, frames);
  EXPECT_EQ(samples.size(), 600U + 755U);
  EXPECT_EQ(wrong_samples(samples, 0), 0);
}

class RestartedNode : public ::testing::TestWithParam<std::int64_t> {};

TEST_P(RestartedNode, IsRealignedByTimeAndCounted) {
  const Nodes nodes;
  SampleAssembler assembler{nodes.config()};
  std::vector<CanFrame> frames;
  for (std::int64_t tick = 0; tick < 4000; ++tick) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      if (c == 1 && tick >= 2000 && tick < 2060) continue;  // the node boots for 0.2 s
      const std::int64_t shift = c == 1 && tick >= 2060 ? GetParam() : 0;
      frames.push_back(nodes.frame(c, tick, 0, shift));
    }
  }
  const auto samples = assemble(assembler, frames);
  EXPECT_EQ(wrong_samples(samples, 0), 0);
  EXPECT_EQ(assembler.counts().channels[1].realigned, 1U);
  EXPECT_GE(samples.size(), 4000U - 60U - 4U);
}

INSTANTIATE_TEST_SUITE_P(CounterShift, RestartedNode,
                         ::testing::Values(-2060, 3, -3, 10, -10, 77, 128));

TEST(Assembler, IgnoresASingleFrameWhoseCounterIsCorrupt) {
  const Nodes nodes;
  SampleAssembler assembler{nodes.config()};
  auto frames = run(nodes, 0, 1000);
  frames[1501].data[2] = static_cast<std::uint8_t>(frames[1501].data[2] + 100);
  const auto samples = assemble(assembler, frames);
  EXPECT_EQ(samples.size(), 999U);
  EXPECT_EQ(wrong_samples(samples, 0), 0);
  EXPECT_EQ(assembler.counts().channels[1].out_of_step, 1U);
}

TEST(Assembler, IsNotShiftedByALateFirstFrame) {
  for (const unsigned bits : {0U, 8U}) {
    const Nodes nodes{.counter_bits = bits};
    SampleAssembler assembler{nodes.config()};
    auto frames = run(nodes, 0, 600);
    frames[1].time_ns += 2'400'000;  // 0.72 periods
    sort_by_time(frames);
    const auto samples = assemble(assembler, frames);
    EXPECT_GE(samples.size(), 599U) << bits;
    EXPECT_EQ(wrong_samples(samples, 600 - static_cast<std::int64_t>(samples.size())), 0) << bits;
  }
}

TEST(Assembler, CountsWhatItDoesNotUse) {
  const Nodes nodes;
  SampleAssembler assembler{nodes.config()};
  auto frames = run(nodes, 0, 100);
  CanFrame other = frames[0];
  other.id = 0x7FF;
  CanFrame look_alike = frames[0];  // the same number, but 29 bits
  look_alike.extended = true;
  CanFrame remote = frames[1];
  remote.remote = true;
  CanFrame error = frames[1];
  error.error = true;
  CanFrame brief = frames[2];
  brief.length = 2;
  for (const CanFrame& frame : {other, look_alike, remote, error, brief}) frames.push_back(frame);
  EXPECT_EQ(assemble(assembler, frames).size(), 100U);
  EXPECT_EQ(assembler.counts().frames, 305U);
  EXPECT_EQ(assembler.counts().foreign, 2U);
  EXPECT_EQ(assembler.counts().error, 1U);
  EXPECT_EQ(assembler.counts().channels[1].not_data, 1U);
  EXPECT_EQ(assembler.counts().channels[2].wrong_length, 1U);
}

TEST(Assembler, MarksAFullScaleCode) {
  const Nodes nodes;
  SampleAssembler assembler{nodes.config()};
  auto frames = run(nodes, 0, 100);
  frames[151].data[0] = 0xFF;  // channel 1, tick 50: 2047
  frames[151].data[1] = 0x07;
  frames[212].data[0] = 0x00;  // channel 2, tick 70: -2048
  frames[212].data[1] = 0x08;
  const auto samples = assemble(assembler, frames);
  ASSERT_EQ(samples.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(samples[i].saturated, i == 50 ? 2 : i == 70 ? 4 : 0) << i;
  }
  EXPECT_EQ(assembler.counts().channels[1].saturated, 1U);
}

TEST(Assembler, ReadsThreeSignalsOfOneMessage) {
  AssemblerConfig config;
  for (std::size_t c = 0; c < kChannels; ++c) {
    config.channels[c].id = 0x18FF0001;
    config.channels[c].extended = true;
    config.channels[c].accel = {
        .start_bit = static_cast<std::uint16_t>(16 * c), .length = 16, .is_signed = true};
    config.channels[c].has_counter = true;
    config.channels[c].counter = {.start_bit = 48, .length = 8};
  }
  SampleAssembler assembler{config};
  std::vector<CanFrame> frames;
  for (int tick = 0; tick < 500; ++tick) {
    CanFrame frame;
    frame.id = 0x18FF0001;
    frame.extended = true;
    frame.length = 7;
    frame.time_ns = tick * 3'333'333LL;
    for (std::size_t c = 0; c < kChannels; ++c)
      frame.data[2 * c] = static_cast<std::uint8_t>(tick % 100);
    for (std::size_t c = 0; c < kChannels; ++c)
      frame.data[2 * c + 1] = static_cast<std::uint8_t>(c);
    frame.data[6] = static_cast<std::uint8_t>(tick);
    frames.push_back(frame);
  }
  const auto samples = assemble(assembler, frames);
  ASSERT_EQ(samples.size(), 500U);
  for (std::size_t c = 0; c < kChannels; ++c) {
    EXPECT_DOUBLE_EQ(samples[42].accel_mps2[c], 42.0 + 256.0 * static_cast<double>(c));
  }
}

TEST(Assembler, SeparatesChannelsOfOneIdentifierByTheirMultiplexor) {
  const Nodes nodes;
  AssemblerConfig config = nodes.config();
  for (std::size_t c = 0; c < kChannels; ++c) {
    config.channels[c].id = 0x200;
    config.channels[c].multiplexed = true;
    config.channels[c].multiplexor = {.start_bit = 12, .length = 4};
    config.channels[c].multiplexor_value = c + 5;
  }
  SampleAssembler assembler{config};
  auto frames = run(nodes, 0, 500);
  for (CanFrame& frame : frames) {
    frame.data[1] =
        static_cast<std::uint8_t>((frame.data[1] & 0x0FU) | (frame.id - 0x100 + 5) << 4U);
    frame.id = 0x200;
  }
  const auto samples = assemble(assembler, frames);
  EXPECT_EQ(samples.size(), 500U);
  EXPECT_EQ(wrong_samples(samples, 0), 0);
}

TEST(Assembler, ListensToTheNamedInterfaceOnly) {
  const Nodes nodes;
  AssemblerConfig config = nodes.config();
  for (ChannelConfig& channel : config.channels) channel.interface_index = 1;
  SampleAssembler assembler{config};
  auto frames = run(nodes, 0, 100);
  for (std::size_t i = 0; i < frames.size(); ++i) frames[i].interface_index = i < 150 ? 0 : 1;
  EXPECT_EQ(assemble(assembler, frames).size(), 50U);
  EXPECT_EQ(assembler.counts().foreign, 150U);
}

TEST(Assembler, RefusesAConfigurationThatCannotWork) {
  const Nodes nodes;
  AssemblerConfig config = nodes.config();
  EXPECT_TRUE(SampleAssembler::check(config).ok());
  for (const double rate_hz : {std::nan(""), 0.0, -300.0, 1.1e6}) {
    config.sample_rate_hz = rate_hz;
    EXPECT_FALSE(SampleAssembler::check(config).ok()) << rate_hz;
  }
  config.sample_rate_hz = 1e6;
  EXPECT_TRUE(SampleAssembler::check(config).ok());
  config = nodes.config();
  config.channels[1].id = 0x800;
  EXPECT_FALSE(SampleAssembler::check(config).ok());
  config = nodes.config();
  config.channels[2].accel.length = 0;
  EXPECT_FALSE(SampleAssembler::check(config).ok());
}

TEST(Assembler, AnInstantWaitsSixteenTicksForItsChannels) {
  const Nodes nodes;
  SampleAssembler assembler{nodes.config()};
  for (const CanFrame& frame : run(nodes, 0, 100)) assembler.push(frame);
  EXPECT_EQ(assembler.counts().samples, 100U);
  for (std::int64_t tick = 100; tick < 150; ++tick) {  // the third channel is off
    assembler.push(nodes.frame(0, tick));
    assembler.push(nodes.frame(1, tick));
    const std::uint64_t given_up = tick < 116 ? 0 : static_cast<std::uint64_t>(tick - 115);
    EXPECT_EQ(assembler.counts().incomplete, given_up) << tick;
  }
}

/// Anything may come over a bus: the assembler must bear it, and ticks must increase.
TEST(Assembler, BearsRandomFrames) {
  std::mt19937_64 random{11};
  for (const unsigned bits : {0U, 1U, 4U, 16U, 48U}) {
    const Nodes nodes{.counter_bits = bits};
    SampleAssembler assembler{nodes.config()};
    std::int64_t time_ns = 0;
    std::int64_t last_tick = std::numeric_limits<std::int64_t>::min();
    Sample sample;
    for (int i = 0; i < 200'000; ++i) {
      CanFrame frame;
      frame.id = static_cast<std::uint32_t>(0x100 + random() % 4);
      frame.length = static_cast<std::uint8_t>(random() % 9);
      for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
      const std::uint64_t kind = random() % 1000;
      time_ns += kind == 0    ? 1'000'000'000'000
                 : kind < 100 ? 0
                              : static_cast<std::int64_t>(random() % 4'000'000);
      frame.time_ns = time_ns;
      assembler.push(frame);
      while (assembler.pop(sample)) {
        ASSERT_GT(sample.tick, last_tick);
        last_tick = sample.tick;
      }
    }
    EXPECT_EQ(assembler.counts().overflow, 0U);
  }
}

// A node that is switched on later: what the others sent before is no instant that lacks it.
TEST(Assembler, BeginsWithTheFirstInstantOfAllChannels) {
  for (std::size_t late = 0; late < kChannels; ++late) {
    for (const std::int64_t shift : {0, 100}) {
      const Nodes nodes;
      AssemblerConfig config = nodes.config();
      config.most_missing = 3;
      SampleAssembler assembler{config};
      std::vector<CanFrame> frames;
      for (std::int64_t tick = 0; tick < 300; ++tick)
        for (std::size_t c = 0; c < kChannels; ++c)
          if (c != late || tick >= 3) frames.push_back(nodes.frame(c, tick, 0, c == 1 ? shift : 0));
      const auto samples = assemble(assembler, frames);
      EXPECT_EQ(samples.size(), 297U) << late;
      EXPECT_EQ(wrong_samples(samples, 3), 0);
      EXPECT_EQ(assembler.counts().incomplete, 0U);
    }
  }
}

}  // namespace
}  // namespace dampline

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "dampline/sample/assembler.hpp"
#include "dampline/sample/hole_bridge.hpp"
#include "frame_maker.hpp"

namespace dampline {
namespace {

using test::assemble;
using test::Nodes;
using test::run;

/// The three nodes and two more, of the identifiers after theirs.
struct FiveNodes {
  Nodes nodes;
  [[nodiscard]] AssemblerConfig config(bool end, bool far) const {
    AssemblerConfig all = nodes.config();
    for (std::size_t e = 0; e < kExtras; ++e) {
      if (e == 0 ? !end : !far) continue;
      all.extras[e] = all.channels[0];
      all.extras[e]->id = static_cast<std::uint32_t>(0x103 + e);
    }
    return all;
  }
  [[nodiscard]] std::vector<CanFrame> frames(std::int64_t ticks) const {
    std::vector<CanFrame> out;
    for (std::int64_t tick = 0; tick < ticks; ++tick)
      for (std::size_t c = 0; c < 5; ++c) out.push_back(nodes.frame(c, tick));
    return out;
  }
};

TEST(Extras, JoinTheSampleOfTheirInstant) {
  const FiveNodes five;
  for (const auto& [end, far] :
       {std::pair{true, true}, std::pair{false, true}, std::pair{true, false}}) {
    SampleAssembler assembler{five.config(end, far)};
    const auto samples = assemble(assembler, five.frames(300));
    ASSERT_EQ(samples.size(), 300U);
    EXPECT_EQ(test::wrong_samples(samples, 0), 0);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto tick = static_cast<std::int64_t>(i);
      EXPECT_FLOAT_EQ(samples[i].extra_mps2[0],
                      end ? static_cast<float>(Nodes::value(3, tick)) : 0.0F);
      EXPECT_FLOAT_EQ(samples[i].extra_mps2[1],
                      far ? static_cast<float>(Nodes::value(4, tick)) : 0.0F);
      EXPECT_EQ(samples[i].wheelset_after_us[0], 200);
      EXPECT_EQ(samples[i].wheelset_after_us[1], 400);
    }
    EXPECT_EQ(assembler.counts().lanes, end && far ? 5U : 4U);
    EXPECT_EQ(assembler.counts().foreign, end && far ? 0U : 300U);
    const FrameLedger ledger = ledger_of(assembler.counts(), 0);
    EXPECT_EQ(ledger.sent, 1500U);
    EXPECT_EQ(ledger.without_partner, 0U);
  }
}

TEST(Extras, AreWaitedForAndSaturate) {
  const FiveNodes five;
  SampleAssembler assembler{five.config(true, true)};
  auto frames = five.frames(300);
  frames[5 * 40 + 3].data[0] = 0xFF;  // 2047
  frames[5 * 40 + 3].data[1] = 0x07;
  frames[5 * 50 + 4].data[0] = 0x00;  // -2048
  frames[5 * 50 + 4].data[1] = 0x08;
  frames.erase(frames.begin() + 5 * 100 + 4);
  const auto samples = assemble(assembler, frames);
  ASSERT_EQ(samples.size(), 299U);
  EXPECT_EQ(samples[40].saturated, 1U << 3);
  EXPECT_EQ(samples[50].saturated, 1U << 4);
  EXPECT_EQ(samples[100].tick - samples[99].tick, 2);
}

TEST(Extras, AreCheckedAsTheOthersAre) {
  const FiveNodes five;
  AssemblerConfig config = five.config(true, true);
  EXPECT_TRUE(SampleAssembler::check(config).ok());
  config.extras[1]->accel.length = 0;
  EXPECT_FALSE(SampleAssembler::check(config).ok());
}

TEST(Extras, ValuesThatAreMissingArePutIn) {
  HoleBridge bridge;
  std::vector<Sample> out;
  const auto value = [](std::int64_t tick) { return std::sin(0.2 * static_cast<double>(tick)); };
  const auto take = [&] {
    for (Sample sample; bridge.pop(sample);) out.push_back(sample);
  };
  for (std::int64_t tick = 0; tick < 1500; ++tick) {
    Sample sample{.tick = tick, .accel_mps2 = {value(tick), value(tick + 5), value(tick + 9)}};
    sample.extra_mps2 = {static_cast<float>(value(tick + 2)), 0.0F};
    if (tick == 900) sample.extra_mps2[0] = std::numeric_limits<float>::quiet_NaN();
    if (tick >= 1200 && tick < 1204) sample.extra_mps2[0] = std::numeric_limits<float>::quiet_NaN();
    bridge.push(sample);
    take();
  }
  bridge.finish();
  take();
  ASSERT_EQ(out.size(), 1500U);
  EXPECT_NEAR(out[900].extra_mps2[0], value(902), 1e-3);
  EXPECT_EQ(out[900].bridged, 1U << 3);
  EXPECT_EQ(bridge.figures().values, 1U);
  EXPECT_NEAR(bridge.figures().share, 1.0 / 1500.0, 1e-12);
  EXPECT_EQ(bridge.figures().error_mps2[0], 0.0) << "of the three alone";
  for (std::size_t i = 0; i < out.size(); ++i) {
    const bool useless = i >= 1200 && i < 1204;
    EXPECT_EQ(std::isnan(out[i].accel_mps2[0]), useless) << "nobody looks at an extra by itself";
    EXPECT_FALSE(std::isnan(out[i].accel_mps2[1]));
  }
}

TEST(Assembler, LosesSamplesThatNobodyTakesAndCountsThem) {
  const Nodes nodes;
  SampleAssembler assembler{nodes.config()};
  for (const CanFrame& frame : run(nodes, 0, 300)) assembler.push(frame);
  EXPECT_EQ(assembler.counts().samples, 128U);
  EXPECT_EQ(assembler.counts().overflow, 300U - 128U);
  std::vector<Sample> samples;
  for (Sample sample; assembler.pop(sample);) samples.push_back(sample);
  EXPECT_EQ(samples.size(), 128U);
  EXPECT_EQ(test::wrong_samples(samples, 0), 0);
}

TEST(Assembler, StatesHowMuchLaterWheelsetsWereInMicroseconds) {
  const Nodes nodes{.rate_hz = 10.0};
  SampleAssembler assembler{nodes.config()};
  auto frames = run(nodes, 0, 100);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i % 3 == 1) frames[i].time_ns += 40'000'000;
    if (i % 3 == 2) frames[i].time_ns -= 30'000'400;
  }
  test::sort_by_time(frames);
  const auto samples = assemble(assembler, frames);
  ASSERT_GE(samples.size(), 98U);
  for (const Sample& sample : samples) {
    EXPECT_EQ(sample.wheelset_after_us[0], 32'767) << "as near as 16 bits can";
    EXPECT_EQ(sample.wheelset_after_us[1], -29'600);
  }
}

TEST(Assembler, TakesInterfaceZeroForOneAsWell) {
  const Nodes nodes;
  AssemblerConfig config = nodes.config();
  for (ChannelConfig& channel : config.channels) channel.interface_index = 0;
  SampleAssembler assembler{config};
  auto frames = run(nodes, 0, 100);
  for (std::size_t i = 150; i < frames.size(); ++i) frames[i].interface_index = 1;
  EXPECT_EQ(assemble(assembler, frames).size(), 50U);
}

TEST(Ledger, CountsFramesOfAnotherPage) {
  const Nodes nodes;
  AssemblerConfig config = nodes.config();
  for (std::size_t c = 0; c < kChannels; ++c) {
    config.channels[c].multiplexed = true;
    config.channels[c].multiplexor = {.start_bit = 12, .length = 4};
    config.channels[c].multiplexor_value = 5;
  }
  SampleAssembler assembler{config};
  auto frames = run(nodes, 0, 300);
  for (CanFrame& frame : frames)
    frame.data[1] = static_cast<std::uint8_t>((frame.data[1] & 0x0FU) | 0x50U);
  for (std::size_t i = 300; i < 330; ++i) frames[i].data[1] ^= 0x10U;
  for (std::size_t i = 400; i < 404; ++i) frames[i].length = 1;
  static_cast<void>(assemble(assembler, frames));
  const FrameLedger ledger = ledger_of(assembler.counts(), 0);
  EXPECT_EQ(ledger.other_page, 30U);
  EXPECT_EQ(ledger.wrong_length, 4U);
  EXPECT_EQ(ledger.excluded, 30U + 4U + ledger.without_partner);
  EXPECT_EQ(ledger.sent, ledger.processed + ledger.gaps + ledger.excluded);
}

}  // namespace
}  // namespace dampline

// SPDX-License-Identifier: MIT
#include "dampline/guard/timing_watch.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>

namespace dampline {
namespace {

constexpr double kTimingRateHz = 300.0;
constexpr std::int64_t kBlock = 3072;
constexpr std::int64_t kHop = 256;
constexpr double kUsualS = 0.0815;  // of wheelset 2

/// What a block shows: the delay of wheelset 2, and the frame's lags behind the mean and either.
struct Shown {
  double delay_s{kUsualS};
  std::array<double, 3> lag_s{};
  bool has_delay{true};
  bool has_lag{true};
};

/// Feeds blocks and their segments; scatter of a microsecond to and fro.
class Blocks {
 public:
  explicit Blocks(double rate_hz = kTimingRateHz)
      : log_{std::make_unique<FaultLog>(rate_hz)}, watch_{rate_hz} {}
  bool show(const Shown& shown) {
    const double off_s = count_ % 2 == 0 ? 1e-6 : -1e-6;
    BlockFigures block;
    block.first_tick = count_ * kBlock;
    block.last_tick = block.first_tick + kBlock - 2;
    block.delay_s = shown.delay_s + off_s;
    block.has_lag = shown.has_lag;
    for (std::size_t i = 0; i < 3; ++i) block.lag_s[i] = shown.lag_s[i] + off_s;
    if (segments_)
      for (std::int64_t tick = block.first_tick; tick < block.first_tick + kBlock; tick += kHop)
        watch_.add_segment(tick, segments_(tick, shown));
    ++count_;
    const bool other = watch_.add_block(block, shown.has_delay, inputs_);
    watch_.judge(*log_, inputs_);
    return other;
  }
  void show(int blocks, const Shown& shown) {
    for (int i = 0; i < blocks; ++i) static_cast<void>(show(shown));
  }
  void set_segments(std::function<double(std::int64_t, const Shown&)> segments) {
    segments_ = std::move(segments);
  }
  TimingWatch& watch() { return watch_; }
  [[nodiscard]] std::span<const Fault> faults() const { return log_->faults(); }
  [[nodiscard]] std::uint64_t speed_changes() const { return inputs_.speed_changes; }
  [[nodiscard]] std::int64_t now() const { return count_ * kBlock; }

 private:
  std::unique_ptr<FaultLog> log_;
  TimingWatch watch_;
  GuardInputs inputs_;
  std::int64_t count_{0};
  std::function<double(std::int64_t, const Shown&)> segments_;
};

/// A wheelset whose samples come later by this: the delay between them, and the frame's lags.
Shown wheelset1_late(double late_s) { return {kUsualS - late_s, {-0.5 * late_s, -late_s, 0.0}}; }
Shown wheelset2_late(double late_s) { return {kUsualS + late_s, {-0.5 * late_s, 0.0, -late_s}}; }
Shown frame_late(double late_s) { return {kUsualS, {late_s, late_s, late_s}}; }
/// Another speed: the frame lags the mean as before.
Shown faster(double less_s) { return {kUsualS - less_s, {0.0, -0.5 * less_s, 0.5 * less_s}}; }

struct Named {
  FaultKind kind;
  FaultChannel channel;
  double size;
};
void expect_only(const Blocks& blocks, const Named& named, double tolerance) {
  ASSERT_EQ(blocks.faults().size(), 1U);
  const Fault& fault = blocks.faults()[0];
  EXPECT_EQ(fault.kind, named.kind);
  EXPECT_EQ(fault.channel, named.channel);
  EXPECT_NEAR(fault.size, named.size, tolerance);
}

TEST(TimingWatch, SaysNothingOfWhatStays) {
  Blocks blocks;
  blocks.show(40, {});
  EXPECT_TRUE(blocks.faults().empty());
  EXPECT_EQ(blocks.speed_changes(), 0U);
  EXPECT_NEAR(blocks.watch().delay_s(), kUsualS, 2e-6);
}

TEST(TimingWatch, NamesTheWheelsetThatIsOutOfStep) {
  for (const double late_s : {0.002, -0.0016}) {
    Blocks one;
    one.show(12, {});
    one.show(5, wheelset1_late(late_s));
    expect_only(one, {FaultKind::kTimingStep, FaultChannel::kWheelset1, late_s}, 2e-6);
    EXPECT_NEAR(one.watch().delay_s(), kUsualS - late_s, 2e-6) << "by what came since";
    EXPECT_NEAR(one.faults()[0].time_s, 12 * kBlock / kTimingRateHz, 0.1);
    Blocks two;
    two.show(12, {});
    two.show(4, wheelset2_late(late_s));
    expect_only(two, {FaultKind::kTimingStep, FaultChannel::kWheelset2, late_s}, 2e-6);
    EXPECT_NEAR(two.watch().delay_s(), kUsualS + late_s, 2e-6) << "three blocks are left";
  }
}

// In the middle of the series half of the change looks like a line.
TEST(TimingWatch, AStepWithinABlockIsAStepWhereverItIs) {
  constexpr double kLateS = 0.0016;
  for (int before = 3; before < 14; ++before) {
    for (const double share : {0.25, 0.5, 0.75}) {
      Blocks blocks;
      blocks.show(before, {});
      blocks.show(1, wheelset2_late(share * kLateS));
      blocks.show(5, wheelset2_late(kLateS));
      expect_only(blocks, {FaultKind::kTimingStep, FaultChannel::kWheelset2, kLateS}, 2e-6);
    }
  }
}

TEST(TimingWatch, AStepOfWholeSamplesIsSamplesLostOrRepeated) {
  for (const int samples : {1, 2}) {
    Blocks late;
    late.show(12, {});
    late.show(5, wheelset2_late(samples / kTimingRateHz));
    expect_only(late, {FaultKind::kRepeatedSamples, FaultChannel::kWheelset2, 1.0 * samples}, 0.0);
    Blocks early;
    early.show(12, {});
    early.show(5, wheelset1_late(-samples / kTimingRateHz));
    expect_only(early, {FaultKind::kLostSamples, FaultChannel::kWheelset1, 1.0 * samples}, 0.0);
  }
}

// Within 0.03 of a sample between the wheelsets, and 0.05 of the frame.
TEST(TimingWatch, ToleratesAFewHundredthsOfASample) {
  const auto kind_of = [](const Shown& shown) {
    Blocks blocks;
    blocks.show(12, {});
    blocks.show(5, shown);
    EXPECT_EQ(blocks.faults().size(), 1U);
    return blocks.faults().empty() ? FaultKind::kJitter : blocks.faults()[0].kind;
  };
  EXPECT_EQ(kind_of(wheelset2_late(1.025 / kTimingRateHz)), FaultKind::kRepeatedSamples);
  EXPECT_EQ(kind_of(wheelset2_late(0.965 / kTimingRateHz)), FaultKind::kTimingStep);
  EXPECT_EQ(kind_of(frame_late(1.045 / kTimingRateHz)), FaultKind::kRepeatedSamples);
  EXPECT_EQ(kind_of(frame_late(-0.955 / kTimingRateHz)), FaultKind::kLostSamples);
  EXPECT_EQ(kind_of(frame_late(0.935 / kTimingRateHz)), FaultKind::kTimingStep);
}

// At 100 samples a second a quarter of a millisecond is a fortieth of a sample, and none is lost.
TEST(TimingWatch, AStepOfHardlyAnythingIsNoWholeSample) {
  for (const double late_s : {250e-6, -250e-6}) {
    Blocks blocks{100.0};
    blocks.show(12, {});
    blocks.show(5, wheelset2_late(late_s));
    expect_only(blocks, {FaultKind::kTimingStep, FaultChannel::kWheelset2, late_s}, 2e-6);
  }
}

TEST(TimingWatch, NamesTheFrameThatIsOutOfStep) {
  Blocks blocks;
  blocks.show(12, {});
  blocks.show(5, frame_late(0.0014));
  expect_only(blocks, {FaultKind::kTimingStep, FaultChannel::kFrame, 0.0014}, 2e-6);
  EXPECT_NEAR(blocks.faults()[0].time_s, 12 * kBlock / kTimingRateHz, 0.1);
  blocks.show(20, frame_late(0.0014));
  EXPECT_EQ(blocks.faults()[0].count, 1U) << "once";
}

TEST(TimingWatch, LooksForALeastChange) {
  const auto is_named = [](const Shown& shown) {
    Blocks blocks;
    blocks.show(12, {});
    blocks.show(8, shown);
    return !blocks.faults().empty();
  };
  EXPECT_FALSE(is_named(wheelset2_late(140e-6)));
  EXPECT_TRUE(is_named(wheelset2_late(160e-6)));
  EXPECT_FALSE(is_named(frame_late(0.48e-3)));
  EXPECT_TRUE(is_named(frame_late(0.52e-3)));
}

TEST(TimingWatch, NeedsSevenBlocksThreeOfThemAfterAndOneMore) {
  for (const auto& late : {wheelset2_late, frame_late}) {
    Blocks blocks;
    blocks.show(3, {});
    blocks.show(3, late(0.002));
    EXPECT_TRUE(blocks.faults().empty()) << "six in all";
    blocks.show(1, late(0.002));
    EXPECT_EQ(blocks.faults().size(), 1U);
    Blocks longer;
    longer.show(12, {});
    longer.show(3, late(0.002));
    EXPECT_TRUE(longer.faults().empty());
    longer.show(1, late(0.002));
    EXPECT_EQ(longer.faults().size(), 1U);
  }
}

TEST(TimingWatch, TakesAFrameThatMovesAgainstOneWheelsetOnlyForNoFault) {
  for (const std::size_t other : {1U, 2U}) {
    Blocks blocks;
    blocks.show(12, {});
    Shown shown = frame_late(0.002);
    shown.lag_s[other] = 0.0009;  // less than half
    blocks.show(8, shown);
    EXPECT_TRUE(blocks.faults().empty());
    shown = frame_late(0.002);
    shown.lag_s[other] = 0.0011;
    Blocks more;
    more.show(12, {});
    more.show(8, shown);
    EXPECT_EQ(more.faults().size(), 1U);
  }
}

TEST(TimingWatch, TakesAnotherSpeedForARide) {
  Blocks blocks;
  blocks.show(12, {});
  blocks.show(8, faster(0.004));
  EXPECT_TRUE(blocks.faults().empty());
  EXPECT_EQ(blocks.speed_changes(), 1U);
  EXPECT_NEAR(blocks.watch().delay_s(), kUsualS - 0.004, 2e-6);
  Blocks fewer;
  fewer.show(12, {});
  fewer.show(4, faster(0.004));
  EXPECT_EQ(fewer.speed_changes(), 1U);
  EXPECT_NEAR(fewer.watch().delay_s(), kUsualS - 0.004, 2e-6) << "the newest three are kept";
}

// The frame's lag behind the mean stays where it moves by a quarter of the delay's change or less.
TEST(TimingWatch, AQuarterOfTheChangeStays) {
  for (const auto& [share, named] : {std::pair{0.24, false}, std::pair{0.27, true}}) {
    Blocks blocks;
    blocks.set_segments([](std::int64_t, const Shown& shown) { return shown.delay_s; });
    blocks.show(12, {});
    Shown shown = faster(0.004);
    shown.lag_s[0] = share * 0.004;
    blocks.show(8, shown);
    EXPECT_EQ(!blocks.faults().empty(), named) << share;
    EXPECT_EQ(blocks.speed_changes(), named ? 0U : 1U);
  }
}

// A tenth of the change: so near are the lags where one wheelset is out of step.
TEST(TimingWatch, AWheelsetIsOutOfStepByTheFramesLagsToATenth) {
  const auto channel_of_step = [](std::array<double, 3> shares) {
    Blocks blocks;
    blocks.set_segments([](std::int64_t, const Shown& shown) { return shown.delay_s; });
    blocks.show(12, {});
    for (double& share : shares) share *= 0.002;
    blocks.show(8, {.delay_s = kUsualS + 0.002, .lag_s = shares});
    EXPECT_EQ(blocks.faults().size(), 1U);
    return blocks.faults().empty() ? FaultChannel::kAll : blocks.faults()[0].channel;
  };
  EXPECT_EQ(channel_of_step({0.5, 1.09, 0.09}), FaultChannel::kWheelset1);
  EXPECT_EQ(channel_of_step({0.5, -0.91, -0.09}), FaultChannel::kWheelset1);
  EXPECT_EQ(channel_of_step({0.5, 0.05, 1.05}), FaultChannel::kWheelset2);
  EXPECT_EQ(channel_of_step({0.5, 1.12, 0.0}), FaultChannel::kWheelsets);
  EXPECT_EQ(channel_of_step({0.5, 1.0, 0.12}), FaultChannel::kWheelsets);
  EXPECT_EQ(channel_of_step({0.5, 0.12, 1.0}), FaultChannel::kWheelsets);
  EXPECT_EQ(channel_of_step({0.5, 0.0, 0.88}), FaultChannel::kWheelsets);
}

// Where a wheelset is far out of step the lag behind the mean may stay: its own jump tells.
TEST(TimingWatch, AWheelsetThatJumpedIsOutOfStepEvenWhereTheMeanStays) {
  for (const bool jumped : {false, true}) {
    Blocks blocks;
    blocks.show(12, {});
    if (jumped) blocks.watch().set_jump(12 * kBlock);
    blocks.show(8, {.delay_s = kUsualS + 0.01, .lag_s = {0.0, 0.0, -0.01}});
    EXPECT_EQ(blocks.speed_changes(), jumped ? 0U : 1U);
    ASSERT_EQ(blocks.faults().size(), jumped ? 1U : 0U);
    if (jumped)
      expect_only(blocks, {FaultKind::kRepeatedSamples, FaultChannel::kWheelset2, 3.0}, 0);
  }
}

// Where the lags do not tell, a change within four segments is a step, a slower one a ride.
TEST(TimingWatch, WithoutLagsASuddenChangeIsAFault) {
  for (const auto& [segments, named] : {std::pair{1.0, true}, std::pair{9.0, false}}) {
    Blocks blocks;
    const std::int64_t from = 12 * kBlock - 1000;
    const double slope = 0.002 / (segments * kHop);
    blocks.set_segments([&](std::int64_t tick, const Shown&) {
      return kUsualS + std::clamp(slope * static_cast<double>(tick - from), 0.0, 0.002);
    });
    blocks.show(12, {.has_lag = false});
    blocks.show(6, {.delay_s = kUsualS + 0.002, .has_lag = false});
    EXPECT_EQ(blocks.faults().size(), named ? 1U : 0U) << segments;
    EXPECT_EQ(blocks.speed_changes(), named ? 0U : 1U);
    if (named) expect_only(blocks, {FaultKind::kTimingStep, FaultChannel::kWheelsets, 0.002}, 2e-6);
  }
}

// Eight seconds across six segments: what changed in a longer gap was not seen to be sudden.
TEST(TimingWatch, AChangeAcrossALongGapIsNotSudden) {
  for (const auto& [gap_s, named] : {std::pair{2.5, true}, std::pair{5.5, false}}) {
    Blocks blocks;
    const auto half = static_cast<std::int64_t>(0.5 * gap_s * kTimingRateHz);
    const std::int64_t step = 12 * kBlock;
    for (int block = 0; block < 18; ++block) {
      const double delay_s = block < 12 ? kUsualS : kUsualS + 0.002;
      const std::int64_t began = blocks.now();
      for (std::int64_t tick = began; tick < began + kBlock; tick += kHop)
        if (tick < step - half || tick >= step + half) blocks.watch().add_segment(tick, delay_s);
      blocks.show({.delay_s = delay_s, .has_lag = false});
    }
    EXPECT_EQ(blocks.faults().size(), named ? 1U : 0U) << gap_s;
    EXPECT_EQ(blocks.speed_changes(), named ? 0U : 1U);
  }
}

// The middle of three counts: one segment that is off by itself makes no sudden change.
TEST(TimingWatch, ASegmentThatIsOffTellsNothing) {
  for (const double off_s : {0.002, -0.002}) {
    Blocks blocks;
    const std::int64_t from = 12 * kBlock - 1000;
    blocks.set_segments([&](std::int64_t tick, const Shown&) {
      const double ramp =
          std::clamp(0.002 / (9.0 * kHop) * static_cast<double>(tick - from), 0.0, 0.002);
      return kUsualS + ramp + (tick / kHop % 12 == 5 ? off_s : 0.0);
    });
    blocks.show(12, {.has_lag = false});
    blocks.show(6, {.delay_s = kUsualS + 0.002, .has_lag = false});
    EXPECT_TRUE(blocks.faults().empty()) << off_s;
    EXPECT_EQ(blocks.speed_changes(), 1U);
  }
}

TEST(TimingWatch, ADelayAnotherByAFifthIsAnotherSpeedAtOnce) {
  for (const auto& [factor, other] : {std::pair{1.19, false}, std::pair{1.21, true},
                                      std::pair{0.81, false}, std::pair{0.79, true}}) {
    Blocks blocks;
    blocks.show(12, {});
    EXPECT_EQ(blocks.show({.delay_s = factor * kUsualS}), other) << factor;
    EXPECT_EQ(blocks.speed_changes(), other ? 1U : 0U);
    EXPECT_EQ(blocks.watch().delay_s() == 0.0, other) << "what came before is forgotten";
  }
}

TEST(TimingWatch, KnowsTheDelayFromThreeBlocks) {
  Blocks blocks;
  EXPECT_EQ(blocks.watch().delay_s(), 0.0);
  blocks.show(2, {});
  EXPECT_EQ(blocks.watch().delay_s(), 0.0);
  blocks.show(1, {});
  EXPECT_NEAR(blocks.watch().delay_s(), kUsualS, 2e-6);
  blocks.show(5, {.delay_s = kUsualS + 1e-4});
  EXPECT_NEAR(blocks.watch().delay_s(), kUsualS + 1e-4, 2e-6) << "the newest six";
  blocks.watch().restart();
  EXPECT_EQ(blocks.watch().delay_s(), 0.0);
}

TEST(TimingWatch, ChangesOfSpeedWithinAMinuteAreOne) {
  for (const auto& [blocks_between, changes] : {std::pair{5, 1U}, std::pair{7, 2U}}) {
    Blocks blocks;
    blocks.show(8, {});
    blocks.show(blocks_between, {.delay_s = 1.5 * kUsualS});
    blocks.show(1, {.delay_s = 2.5 * kUsualS});
    EXPECT_EQ(blocks.speed_changes(), changes) << blocks_between;
  }
}

// 40 ppm: four microseconds in a tenth of a second.
TEST(TimingWatch, MeasuresTheDriftOfAClock) {
  const auto drifting = [](Blocks& blocks, const std::function<Shown(double)>& late) {
    for (int i = 0; i < 30; ++i) blocks.show(late(40e-6 * i * kBlock / kTimingRateHz));
  };
  Blocks one;
  drifting(one, wheelset1_late);
  expect_only(one, {FaultKind::kClockDrift, FaultChannel::kWheelset1, 40.0}, 0.2);
  EXPECT_NEAR(one.faults()[0].time_s, 0.5 * kBlock / kTimingRateHz, 0.1)
      << "from where it is known";
  Blocks two;
  drifting(two, wheelset2_late);
  expect_only(two, {FaultKind::kClockDrift, FaultChannel::kWheelset2, 40.0}, 0.2);
  EXPECT_GT(two.faults()[0].count, 5U) << "again and again";
  Blocks frame;
  drifting(frame, [](double late_s) { return frame_late(late_s); });
  expect_only(frame, {FaultKind::kClockDrift, FaultChannel::kFrame, 40.0}, 0.2);
}

TEST(TimingWatch, TakesNothingOverFromBeforeARestart) {
  Blocks blocks;
  blocks.show(12, {});
  blocks.watch().restart();
  blocks.show(12, wheelset2_late(0.002));
  blocks.watch().restart();
  blocks.show(12, {.delay_s = 1.5 * kUsualS});
  EXPECT_TRUE(blocks.faults().empty());
  EXPECT_EQ(blocks.speed_changes(), 0U);
}

TEST(TimingWatch, TheFramesLagCountsWhileTheDelayIsKnown) {
  Blocks blocks;
  blocks.show(12, {});
  Shown shown = frame_late(0.002);
  shown.has_delay = false;
  blocks.show(8, shown);
  EXPECT_TRUE(blocks.faults().empty());
  Blocks never;  // and where it never was
  never.show(12, {.has_delay = false});
  never.show(8, shown);
  EXPECT_EQ(never.faults().size(), 1U);
}

// 0.85 s: what lies in a segment that was no good tells nothing.
TEST(TimingWatch, TheWheelsetsOwnJumpTellsWhereSegmentsDoNot) {
  for (const auto& [off_s, named] : {std::pair{19.0, true}, std::pair{21.0, false}}) {
    Blocks blocks;
    blocks.show(12, {.has_lag = false});
    blocks.watch().set_jump(12 * kBlock - 1 + static_cast<std::int64_t>(off_s * kTimingRateHz));
    blocks.show(6, {.delay_s = kUsualS + 0.01, .has_lag = false});
    EXPECT_EQ(blocks.faults().size(), named ? 1U : 0U) << off_s;
  }
}

TEST(TimingWatch, MayDiscardAllSegments) {
  Blocks blocks;
  blocks.set_segments([](std::int64_t, const Shown& shown) { return shown.delay_s; });
  blocks.show(3, {});
  blocks.watch().discard_segments(0);
  blocks.watch().discard_segments(0);
  blocks.show(12, {.has_lag = false});
  EXPECT_TRUE(blocks.faults().empty());
}

TEST(TimingWatch, DiscardsSegmentsFromATickOn) {
  for (const bool each_block : {false, true}) {
    Blocks blocks;
    blocks.set_segments([](std::int64_t tick, const Shown&) {
      return tick < 12 * kBlock ? kUsualS : kUsualS + 0.002;
    });
    blocks.show(12, {.has_lag = false});
    for (int i = 0; i < 6; ++i) {
      const std::int64_t began = blocks.now();
      blocks.show({.delay_s = kUsualS + 0.002, .has_lag = false});
      blocks.watch().discard_segments(each_block ? began : 12 * kBlock);
    }
    EXPECT_TRUE(blocks.faults().empty());
    EXPECT_EQ(blocks.speed_changes(), 1U);
  }
}

// The frame's lags count where they are of all blocks but two.
TEST(TimingWatch, TwoBlocksMayLackTheLag) {
  for (const int without : {0, 2, 3}) {
    Blocks blocks;
    blocks.show(without, {.has_lag = false});
    blocks.show(12, {});
    blocks.show(5, wheelset2_late(0.002));
    EXPECT_EQ(blocks.speed_changes(), without > 2 ? 1U : 0U) << without;
    ASSERT_EQ(blocks.faults().size(), without > 2 ? 0U : 1U) << without;
  }
}

// Half of the blocks are as the one before: so little scatter makes a slow drift known while its
// first blocks are all there is.
TEST(TimingWatch, WhatGoesOnAlongALineIsADriftAndNoStep) {
  for (const auto& late : {wheelset1_late, wheelset2_late}) {
    Blocks blocks;
    for (int i = 0; i < 10; ++i) blocks.show(1, late(0.0005 * (i / 2)));
    ASSERT_EQ(blocks.faults().size(), 1U);
    EXPECT_EQ(blocks.faults()[0].kind, FaultKind::kClockDrift);
  }
}

}  // namespace
}  // namespace dampline

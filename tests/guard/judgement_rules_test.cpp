// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>
#include <vector>

#include "dampline/guard/judgement_delay.hpp"
#include "sim_hw/noise.hpp"

namespace dampline {
namespace {

constexpr double kHeldStepMps2 = 0.005;

/// A record of weak normal codes with wrong samples in it, judged; what comes out.
class JudgedRecord {
 public:
  std::set<std::int64_t> wrong{};  ///< in the frame's channel
  std::set<std::int64_t> missing{};
  double jump_mps2{0.0};  ///< of the zero, after 60 s
  std::size_t wait{7200};

  const std::vector<Sample>& run(std::int64_t samples) {
    GuardConfig config;
    config.step_mps2.fill(kHeldStepMps2);
    const auto guard = std::make_unique<Guard>(config);
    const auto delay = std::make_unique<JudgementDelay>(wait);
    sim::Random random{5, sim::Stream::kSensors};
    Sample due;
    for (std::int64_t tick = 0; tick < samples; ++tick) {
      Sample sample{.tick = tick};
      for (double& accel : sample.accel_mps2)
        accel = kHeldStepMps2 * std::round(40.0 * random.normal());
      if (tick > 18'000) sample.accel_mps2[1] += jump_mps2;
      if (wrong.contains(tick)) sample.accel_mps2[0] += 20.0;
      if (wrong.contains(tick)) sample.saturated = 0b101;
      if (missing.contains(tick)) continue;
      in.push_back(sample);
      guard->update(sample);
      if (delay->push(sample, *guard, due)) out.push_back(due);
    }
    guard->finish();
    while (delay->drain(*guard, due)) out.push_back(due);
    counts = delay->counts();
    return out;
  }
  std::vector<Sample> in{};
  std::vector<Sample> out{};
  RepairCounts counts{};
};

TEST(JudgementRules, AWrongSampleIsWhatItsFourNeighboursSay) {
  JudgedRecord record{.wrong = {9000}};
  record.run(20'000);
  ASSERT_EQ(record.out.size(), record.in.size());
  const auto at = [&](std::size_t i) { return record.in[i].accel_mps2[0]; };
  EXPECT_NEAR(record.out[9000].accel_mps2[0],
              (-at(8998) + 4.0 * at(8999) + 4.0 * at(9001) - at(9002)) / 6.0, 1e-12);
  EXPECT_EQ(record.out[9000].accel_mps2[1], record.in[9000].accel_mps2[1]);
  EXPECT_EQ(record.out[9000].saturated, 0b100) << "of that channel no more";
  EXPECT_FALSE(record.out[9000].spoilt);
  EXPECT_EQ(record.counts.replaced, 1U);
  EXPECT_EQ(record.counts.spoilt, 0U);
}

TEST(JudgementRules, SamplesThatWaitTooShortPassAsTheyAre) {
  JudgedRecord record{.wrong = {9000}, .wait = 300};
  record.run(20'000);
  EXPECT_EQ(record.out[9000].accel_mps2, record.in[9000].accel_mps2);
  EXPECT_EQ(record.counts.replaced, 0U);
}

// A gap that ticks show spoils nothing; seconds of a jump are left out.
TEST(JudgementRules, SecondsOfAFaultThatPassesAreLeftOut) {
  JudgedRecord gap{.missing = {9000, 9001, 9002}};
  gap.run(20'000);
  EXPECT_EQ(gap.counts.spoilt, 0U);
  JudgedRecord jump{.jump_mps2 = 1.0};
  jump.run(30'000);
  std::uint64_t spoilt = 0;
  for (const Sample& sample : jump.out) {
    spoilt += sample.spoilt ? 1U : 0U;
    if (sample.spoilt) {
      EXPECT_NEAR(static_cast<double>(sample.tick), 18'000.0, 700.0);
    }
  }
  EXPECT_EQ(jump.counts.spoilt, spoilt);
  EXPECT_GE(spoilt, 600U) << "a second to either side";
  EXPECT_EQ(spoilt % 300, 0U) << "whole seconds";
}

TEST(JudgementRules, HoldsTenThousandAtMost) {
  const auto delay = std::make_unique<JudgementDelay>(20'000);
  const auto guard = std::make_unique<Guard>(GuardConfig{});
  Sample due;
  for (std::int64_t tick = 0; tick < 10'010; ++tick) {
    const bool out = delay->push({.tick = tick}, *guard, due);
    ASSERT_EQ(out, tick >= 10'000);
    if (out) {
      EXPECT_EQ(due.tick, tick - 10'000);
    }
  }
  int left = 0;
  while (delay->drain(*guard, due)) ++left;
  EXPECT_EQ(left, 10'000);
  EXPECT_EQ(due.tick, 10'009);
}

}  // namespace
}  // namespace dampline

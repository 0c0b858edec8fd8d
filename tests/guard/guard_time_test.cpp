// SPDX-License-Identifier: MIT
// What guards say does not depend on when a record begins, and nothing continues across a gap.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/guard/code_feed.hpp"

namespace dampline {
namespace {

/// A minute and a half with a jump of a zero, clipping, a channel that is stuck, spikes, samples
/// lost and repeated.
std::vector<Fault> faults_of_a_ride(std::int64_t first_tick) {
  Codes codes;
  codes.skip(first_tick);
  std::array<double, 3> last{};
  const auto ride = [&](Sample& sample) {
    const std::int64_t tick = sample.tick - first_tick;
    if (tick >= 9000) sample.accel_mps2[0] += 0.8;
    if (tick >= 15'000 && tick < 15'003) sample.saturated = 0b100;
    if (tick >= 18'000 && tick < 18'200) sample.accel_mps2[2] = Codes::code(17);
    for (const std::int64_t spike : {4000, 5310, 7020})
      if (tick == spike) sample.accel_mps2[1] += Codes::code(2000);
    if (tick >= 21'000 && tick < 22'000 && tick % 100 == 50) sample.accel_mps2 = last;
    last = sample.accel_mps2;
  };
  codes.run(20'500, ride);
  codes.skip(3);
  codes.run(8000, ride);
  codes.guard().finish();
  return {codes.faults().begin(), codes.faults().end()};
}

TEST(GuardTime, AnyTickMayBeTheFirst) {
  const std::vector<Fault> usual = faults_of_a_ride(0);
  EXPECT_EQ(usual.size(), 6U);
  constexpr std::int64_t kLater = 300 * 100'000;
  const std::vector<Fault> later = faults_of_a_ride(kLater);
  ASSERT_EQ(later.size(), usual.size());
  for (std::size_t i = 0; i < usual.size(); ++i) {
    EXPECT_EQ(later[i].kind, usual[i].kind) << i;
    EXPECT_EQ(later[i].channel, usual[i].channel) << i;
    EXPECT_EQ(later[i].count, usual[i].count) << i;
    EXPECT_NEAR(later[i].size, usual[i].size, 1e-9) << i;
    EXPECT_NEAR(later[i].time_s - 100'000.0, usual[i].time_s, 1e-6) << i;
    EXPECT_NEAR(later[i].last_s - 100'000.0, usual[i].last_s, 1e-6) << i;
  }
}

TEST(GuardTime, AChannelThatIsHeldAcrossAPauseIsNotStuck) {
  Codes codes;
  const auto held = [](Sample& sample) { sample.accel_mps2[1] = Codes::code(17); };
  for (int pause = 0; pause < 5; ++pause) {
    codes.run(500);
    codes.run(70, held);
    codes.skip(3000);
    codes.run(70, held);
  }
  EXPECT_EQ(codes.find(FaultKind::kStuckChannel), nullptr);
}

TEST(GuardTime, TheSameSampleBehindAGapIsNoRepetition) {
  for (const std::int64_t missing : {0, 1, 8, 9, 500}) {
    Codes codes;
    std::array<double, 3> last{};
    for (int gap = 0; gap < 14; ++gap) {
      codes.run(100, [&](Sample& sample) { last = sample.accel_mps2; });
      codes.skip(missing);
      codes.run(1, [&](Sample& sample) { sample.accel_mps2 = last; });
    }
    EXPECT_EQ(codes.find(FaultKind::kRepeatedSamples) != nullptr, missing == 0) << missing;
  }
}

TEST(GuardTime, AnotherLevelBehindAGapIsNoImpact) {
  for (const std::int64_t missing : {0, 1, 8, 9, 500}) {
    Codes codes;
    for (int gap = 0; gap < 9; ++gap) {
      codes.run(700, [&](Sample& sample) {
        for (double& accel : sample.accel_mps2) accel += gap % 2 == 0 ? 0.0 : Codes::code(3000);
      });
      codes.skip(missing);
    }
    for (const std::uint64_t impacts : codes.guard().inputs().impacts)
      EXPECT_EQ(impacts > 0, missing == 0) << missing;
    EXPECT_EQ(codes.find(FaultKind::kSpikes), nullptr);
  }
}

// One sample on either side of a wrong one is spoilt, by the second.
TEST(GuardTime, AWrongSampleSpoilsItsNeighbours) {
  for (const auto& [tick, other, spoilt] :
       {std::tuple{3000, 2999, true}, std::tuple{3001, 2999, false}, std::tuple{2999, 3000, true},
        std::tuple{2998, 3000, false}}) {
    Codes codes;
    codes.run(4000, [at = tick](Sample& sample) {
      if (sample.tick == at) sample.accel_mps2[0] += Codes::code(2000);
    });
    EXPECT_TRUE(codes.spoils(FaultKind::kSpikes, tick));
    EXPECT_EQ(codes.spoils(FaultKind::kSpikes, other), spoilt) << tick;
  }
}

TEST(GuardTime, ABlockTellsThirtyTwoSpikesAtMost) {
  Codes codes;
  codes.run(6001, [](Sample& sample) {
    const std::int64_t since = sample.tick - 700;
    const bool spike = since >= 0 && sample.tick < 2390 && since % 43 == since / 43 % 5 * 3;
    if (spike) sample.accel_mps2[2] += Codes::code(2000);
  });
  const Fault* const fault = codes.find(FaultKind::kSpikes);
  ASSERT_NE(fault, nullptr);
  EXPECT_EQ(fault->count, 32U);
}

TEST(GuardTime, ThreeBlocksInARowTellAWrongRate) {
  for (const auto& [seconds, named] : {std::pair{59, false}, std::pair{61, true}}) {
    Codes codes;
    codes.run(seconds * 300, [](Sample& sample) {
      const double right_s = std::min(static_cast<double>(sample.tick) / 300.0, 30.0);
      const double wrong_s = static_cast<double>(sample.tick) / 300.0 - right_s;
      sample.time_ns = std::llround(1e9 * (right_s + 1.01 * wrong_s));
    });
    EXPECT_EQ(codes.find(FaultKind::kWrongSampleRate) != nullptr, named) << seconds;
  }
}

}  // namespace
}  // namespace dampline

// SPDX-License-Identifier: MIT
#include "dampline/motion/fractional_delay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace dampline::app {
namespace {

constexpr double kTruckRateHz = 300.0;

/// Tones up to 120 Hz, at a time.
double tones(double time_s) {
  double sum = 0.0;
  for (const double hz : {1.3, 9.7, 41.0, 88.0, 120.0})
    sum += std::cos(2.0 * std::numbers::pi * hz * time_s + hz);
  return sum;
}

Sample sample_at(std::int64_t tick, double late_s) {
  const double t = static_cast<double>(tick) / kTruckRateHz;
  return {.tick = tick, .accel_mps2 = {tones(t), tones(t - late_s), tones(t)}};
}

TEST(FractionalDelay, SetsALateChannelRightAndLeavesTheOthers) {
  for (const double late_s : {0.0021, -0.0007, 0.0117}) {
    FractionalDelay alignment{{0.0, late_s, 0.0}, kTruckRateHz};
    int seen = 0;
    for (std::int64_t tick = 5; tick < 400; ++tick) {
      const auto out = alignment.next(sample_at(tick, late_s));
      if (!out) continue;
      ++seen;
      EXPECT_EQ(out->tick, tick - FractionalDelay::kHalf);
      const double truth = tones(static_cast<double>(out->tick) / kTruckRateHz);
      EXPECT_NEAR(out->accel_mps2[1], truth, 0.01) << late_s;
      EXPECT_EQ(out->accel_mps2[0], truth);
    }
    EXPECT_EQ(seen, 395 - 2 * FractionalDelay::kHalf);
  }
}

// By whole samples there is nothing between them to guess.
TEST(FractionalDelay, ByWholeSamplesIsExact) {
  FractionalDelay alignment{{0.0, 2.0 / kTruckRateHz, 0.0}, kTruckRateHz};
  for (std::int64_t tick = 0; tick < 100; ++tick) {
    const auto out = alignment.next(sample_at(tick, 2.0 / kTruckRateHz));
    if (!out) continue;
    EXPECT_NEAR(out->accel_mps2[1], tones(static_cast<double>(out->tick) / kTruckRateHz), 1e-9);
  }
}

TEST(FractionalDelay, SetsTwoLateChannelsRight) {
  FractionalDelay alignment{{0.0013, 0.0, -0.0022}, kTruckRateHz};
  for (std::int64_t tick = 0; tick < 200; ++tick) {
    const double t = static_cast<double>(tick) / kTruckRateHz;
    const auto out = alignment.next(
        {.tick = tick, .accel_mps2 = {tones(t - 0.0013), tones(t), tones(t + 0.0022)}});
    if (!out) continue;
    const double truth = tones(static_cast<double>(out->tick) / kTruckRateHz);
    for (const double seen : out->accel_mps2) EXPECT_NEAR(seen, truth, 0.01);
  }
}

TEST(Blackman, FallsFromOneToNothingAtTheEnds) {
  EXPECT_NEAR(blackman(0.0), 1.0, 1e-15);
  EXPECT_NEAR(blackman(0.5), 0.42 - 0.08, 1e-15);
  EXPECT_NEAR(blackman(-1.0 / 3.0), 0.42 + 0.25 - 0.04, 1e-15);
  for (const double beyond : {-1.5, -1.0, 1.0, 1.2}) EXPECT_EQ(blackman(beyond), 0.0);
}

// What a single sample becomes is the filter itself.
TEST(FractionalDelay, IsTheSincWithBlackmansWeights) {
  constexpr double kLate = 0.4;  // samples
  constexpr int kHalf = FractionalDelay::kHalf;
  const auto tap = [](int i) {
    const double x = i - kLate;
    return std::sin(std::numbers::pi * x) / (std::numbers::pi * x) * blackman(x / (kHalf + 1));
  };
  double sum = 0.0;
  for (int i = -kHalf; i <= kHalf; ++i) sum += tap(i);
  FractionalDelay alignment{{0.0, 0.0, kLate / kTruckRateHz}, kTruckRateHz};
  constexpr std::int64_t kPulse = 100;
  for (std::int64_t tick = 0; tick < 200; ++tick) {
    const auto out = alignment.next({.tick = tick, .accel_mps2 = {0, 0, tick == kPulse ? 1.0 : 0}});
    if (!out) continue;
    const auto away = static_cast<int>(kPulse - out->tick);
    EXPECT_NEAR(out->accel_mps2[2], std::abs(away) <= kHalf ? tap(away) / sum : 0.0, 1e-12) << away;
  }
}

TEST(FractionalDelay, OfNothingIsAPureDelay) {
  FractionalDelay alignment{{}, kTruckRateHz};
  for (std::int64_t tick = 1; tick < 100; ++tick) {
    const auto out = alignment.next(sample_at(tick, 0.0));
    if (!out) continue;
    EXPECT_NEAR(out->accel_mps2[1], sample_at(out->tick, 0.0).accel_mps2[1], 1e-12);
  }
}

TEST(FractionalDelay, StartsAnewAfterAGapAndPassesOnWhatIsNoNumber) {
  FractionalDelay alignment{{0.001, 0.0, 0.0}, kTruckRateHz};
  for (std::int64_t tick = 0; tick < 100; ++tick)
    static_cast<void>(alignment.next(sample_at(tick, 0.0)));
  EXPECT_FALSE(alignment.next(sample_at(101, 0.0)));
  Sample hole = sample_at(102, 0.0);
  hole.accel_mps2[2] = std::numeric_limits<double>::quiet_NaN();
  const auto passed = alignment.next(hole);
  ASSERT_TRUE(passed);
  EXPECT_EQ(passed->tick, 102);
  std::int64_t first = 0;
  for (std::int64_t tick = 103; first == 0 && tick < 300; ++tick) {
    const auto out = alignment.next(sample_at(tick, 0.0));
    if (out) first = out->tick;
  }
  EXPECT_EQ(first, 103 + FractionalDelay::kHalf);
}

}  // namespace
}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "dampline/sample/ticks.hpp"

namespace dampline {
namespace {

TEST(RateMeter, FindsTheExactRateOfExactTimes) {
  RateMeter meter{300.0};
  for (std::int64_t tick = 0; tick < 1000; ++tick)
    meter.update(tick + 77, 1'600'000'000'000'000'000 + tick * 4'000'000);
  EXPECT_DOUBLE_EQ(meter.measured().rate_hz, 250.0);
  EXPECT_LT(meter.measured().std_hz, 1e-9);
}

TEST(RateMeter, KnowsNothingFromTwoSamples) {
  RateMeter meter{300.0};
  meter.update(0, 0);
  meter.update(1, 3'000'000);
  EXPECT_EQ(meter.measured().rate_hz, 0.0);
  meter.update(2, 6'000'000);
  EXPECT_NEAR(meter.measured().rate_hz, 1000.0 / 3.0, 1e-9);
}

/// The truth lies within two stated deviations about 95 times in 100.
TEST(RateMeter, StatesAnHonestDeviation) {
  std::mt19937 random{3};
  std::normal_distribution<double> jitter_ns{0.0, 400'000.0};
  int inside = 0;
  for (int record = 0; record < 400; ++record) {
    RateMeter meter{300.0};
    for (std::int64_t tick = 0; tick < 500; ++tick) {
      meter.update(tick, static_cast<std::int64_t>(static_cast<double>(tick) * 1e9 / 300.07 +
                                                   jitter_ns(random)));
    }
    const MeasuredRate rate = meter.measured();
    if (std::abs(rate.rate_hz - 300.07) < 2.0 * rate.std_hz) ++inside;
  }
  EXPECT_GE(inside, 368);
  EXPECT_LE(inside, 394);
}

TEST(RateMeter, LosesNoDigitsOverADay) {
  std::mt19937 random{4};
  std::normal_distribution<double> jitter_ns{0.0, 100'000.0};
  RateMeter meter{300.0};
  const std::int64_t samples = 300LL * 86400;
  for (std::int64_t tick = 0; tick < samples; tick += 16) {
    meter.update(tick, std::llround(static_cast<double>(tick) * 1e9 / 300.003 + jitter_ns(random)));
  }
  const MeasuredRate rate = meter.measured();
  EXPECT_NEAR(rate.rate_hz, 300.003, 4.0 * rate.std_hz);
  // std of a slope: sigma / sqrt(sum of squared ticks), n^3 / 12 of them.
  const double n = static_cast<double>(rate.samples);
  const double expected = 300.0 * 300.0 * 1e-4 / (16.0 * std::sqrt(n * n * n / 12.0));
  EXPECT_NEAR(rate.std_hz, expected, 0.05 * expected);
}

TEST(RateMeter, SegmentsShareTheSlopeOnly) {
  RateMeter meter{300.0};
  for (std::int64_t tick = 0; tick < 100; ++tick) meter.update(tick, tick * 3'300'000);
  meter.begin_segment();
  for (std::int64_t tick = 500; tick < 700; ++tick)
    meter.update(tick, tick * 3'300'000 + 123'456'789);
  EXPECT_NEAR(meter.measured().rate_hz, 1e3 / 3.3, 1e-9);
  EXPECT_EQ(meter.measured().samples, 300U);
}

}  // namespace
}  // namespace dampline

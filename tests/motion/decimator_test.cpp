// SPDX-License-Identifier: MIT
#include "dampline/motion/decimator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace dampline {
namespace {

constexpr double kRecordHz = 1000.0;
constexpr int kFactor = 3;

Sample tone(std::int64_t tick, double hz) {
  const double time_s = static_cast<double>(tick) / kRecordHz;
  const double a = std::cos(2.0 * M_PI * hz * time_s);
  return {tick, std::llround(1e9 * time_s), {a, 2.0 * a, 1.0}, 0};
}

std::vector<Sample> decimated(const std::vector<Sample>& record) {
  Decimator<26> decimator{kFactor};
  std::vector<Sample> out;
  for (const Sample& in : record)
    if (Sample sample; decimator.take(in, sample)) out.push_back(sample);
  return out;
}

std::vector<Sample> tones(double hz) {
  std::vector<Sample> out;
  for (std::int64_t tick = 0; tick < 1500; ++tick) out.push_back(tone(tick, hz));
  return out;
}

TEST(Decimator, TakesWholeFactorsAboveFourHundredHertz) {
  EXPECT_EQ(decimation(300.0), 1);
  EXPECT_EQ(decimation(400.0), 1);
  EXPECT_EQ(decimation(std::nextafter(400.0, 500.0)), 2);
  EXPECT_EQ(decimation(500.0), 2);
  EXPECT_EQ(decimation(kRecordHz), kFactor);
  EXPECT_EQ(decimation(10240.0), 26);
}

TEST(Decimator, KeepsSlowTonesWithTheirPhaseAndTheMean) {
  for (const double hz : {0.5, 20.0, 90.0, 0.38 * kRecordHz / kFactor}) {
    const auto out = decimated(tones(hz));
    ASSERT_GT(out.size(), 400U);
    for (const Sample& sample : out) {
      const Sample truth = tone(sample.tick * kFactor, hz);
      EXPECT_EQ(sample.time_ns, truth.time_ns);
      for (std::size_t c = 0; c < kChannels; ++c)
        EXPECT_NEAR(sample.accel_mps2[c], truth.accel_mps2[c], 2.5e-3) << hz << " Hz";
    }
  }
}

// As its channels: one slow tone in all of them, by the longest filter there may be.
TEST(Decimator, TakesExtraChannelsLikeTheOthers) {
  Decimator<kFactor> decimator{kFactor};
  int seen = 0;
  for (Sample in : tones(20.0)) {
    for (std::size_t e = 0; e < kExtras; ++e)
      in.extra_mps2[e] = static_cast<float>((1.0 + static_cast<double>(e)) * in.accel_mps2[0]);
    Sample out;
    if (!decimator.take(in, out)) continue;
    ++seen;
    for (std::size_t e = 0; e < kExtras; ++e)
      EXPECT_NEAR(out.extra_mps2[e], (1.0 + static_cast<double>(e)) * out.accel_mps2[0], 1e-5);
    EXPECT_NEAR(out.accel_mps2[0], tone(out.tick * kFactor, 20.0).accel_mps2[0], 2.5e-3);
  }
  EXPECT_GT(seen, 400);
}

/// Modified Bessel function of order 0, by its series.
double bessel_i0(double x) {
  double term = 1.0;
  double sum = 1.0;
  for (int k = 1; k < 60; ++k) {
    term *= x / (2.0 * k) * (x / (2.0 * k));
    sum += term;
  }
  return sum;
}

// A single sample comes out as the filter itself, every factor-th tap of it.
TEST(Decimator, IsTheSincUnderKaisersWindow) {
  for (const int factor : {2, 3, 5}) {
    const int half = 48 * factor;
    const auto tap = [&](int i) {
      const double place = i / (half + 1.0);
      const double x = 2.0 * M_PI * 0.48 / factor * i;
      return (i == 0 ? 1.0 : std::sin(x) / x) * bessel_i0(5.65 * std::sqrt(1.0 - place * place));
    };
    double sum = 0.0;
    for (int i = -half; i <= half; ++i) sum += tap(i);
    const std::int64_t pulse = 200 * factor + 1;
    Decimator<26> decimator{factor};
    int seen = 0;
    for (std::int64_t tick = 0; tick < 400 * factor; ++tick) {
      Sample in{.tick = tick};
      in.accel_mps2[2] = tick == pulse ? 1.0 : 0.0;
      in.extra_mps2[1] = tick == pulse ? 2.0F : 0.0F;
      Sample out;
      if (!decimator.take(in, out)) continue;
      const auto away = static_cast<int>(out.tick * factor - pulse);
      const double expected = std::abs(away) <= half ? tap(away) / sum : 0.0;
      seen += expected != 0.0 ? 1 : 0;
      EXPECT_NEAR(out.accel_mps2[2], expected, 1e-13) << away << " of " << factor;
      EXPECT_NEAR(out.extra_mps2[1], 2.0 * expected, 1e-7);
      EXPECT_EQ(out.accel_mps2[0], 0.0);
    }
    EXPECT_EQ(seen, 96);
  }
}

TEST(Decimator, OfOneHandsSamplesOnAsTheyAre) {
  Decimator<2> decimator{1};
  for (std::int64_t tick = 7; tick < 12; ++tick) {
    Sample out;
    ASSERT_TRUE(decimator.take(tone(tick, 20.0), out));
    EXPECT_EQ(out.tick, tick);
    EXPECT_EQ(out.accel_mps2, tone(tick, 20.0).accel_mps2);
  }
}

TEST(Decimator, BeginsWhereTheFilterLiesInTheRecord) {
  const auto out = decimated(tones(20.0));
  EXPECT_EQ(out.front().tick, 48);
  EXPECT_EQ(out.back().tick, (1499 - 48 * kFactor) / kFactor);
}

TEST(Decimator, LeavesNoAliases) {
  for (const double hz : {0.5 * kRecordHz / kFactor + 0.5, 240.0, 333.3, 490.0})
    for (const Sample& sample : decimated(tones(hz)))
      EXPECT_LT(std::abs(sample.accel_mps2[0]), 1.5e-3) << hz << " Hz";
}

TEST(Decimator, LeavesOutWhatAMissingSampleWouldHaveBeenPartOf) {
  auto record = tones(20.0);
  record.erase(record.begin() + 699);
  const auto out = decimated(record);
  const auto whole = decimated(tones(20.0));
  ASSERT_LT(out.size(), whole.size());
  EXPECT_EQ(whole.size() - out.size(), 97U);  // 48 to either side
  for (const Sample& sample : out) {
    EXPECT_GT(std::abs(sample.tick * kFactor - 699), 48 * kFactor);
    EXPECT_NEAR(sample.accel_mps2[0], tone(sample.tick * kFactor, 20.0).accel_mps2[0], 2.5e-3);
  }
}

TEST(Decimator, PassesOnWhatIsWrongInAChannel) {
  auto record = tones(20.0);
  record[600].accel_mps2[1] = std::numeric_limits<double>::quiet_NaN();
  record[900].saturated = 4;
  std::size_t wrong = 0;
  std::size_t saturated = 0;
  for (const Sample& sample : decimated(record)) {
    EXPECT_TRUE(std::isfinite(sample.accel_mps2[0]));
    wrong += std::isnan(sample.accel_mps2[1]) ? 1U : 0U;
    saturated += sample.saturated == 4 ? 1U : 0U;
  }
  EXPECT_EQ(wrong, 97U);
  EXPECT_EQ(saturated, 3U);
}

}  // namespace
}  // namespace dampline

// SPDX-License-Identifier: MIT
#include "dampline/sample/screen.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

namespace dampline {
namespace {

std::vector<Screened> screened(const ScreenConfig& config, const std::vector<Sample>& samples) {
  SampleScreen screen{config};
  std::vector<Screened> all;
  Screened out;
  for (const Sample& sample : samples) {
    if (screen.push(sample, out)) all.push_back(out);
  }
  while (screen.drain(out)) all.push_back(out);
  return all;
}

/// A run in which every channel moves by some m/s^2.
std::vector<Sample> moving(std::int64_t count) {
  std::mt19937 random{1};
  std::normal_distribution<double> noise{0.0, 1.0};
  std::vector<Sample> samples;
  for (std::int64_t tick = 0; tick < count; ++tick) {
    Sample sample;
    sample.tick = tick;
    for (double& accel : sample.accel_mps2) accel = noise(random);
    samples.push_back(sample);
  }
  return samples;
}

void hold(std::vector<Sample>& samples, std::size_t channel, std::size_t from, std::size_t to) {
  for (std::size_t i = from; i < to; ++i)
    samples[i].accel_mps2[channel] = samples[from].accel_mps2[channel];
}

std::vector<std::size_t> with(const std::vector<Screened>& all, Verdict verdict) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].verdict == verdict) found.push_back(i);
  }
  return found;
}

TEST(SampleScreen, PassesEverySampleOfAGoodRunInOrder) {
  const auto samples = moving(1000);
  const auto all = screened({}, samples);
  ASSERT_EQ(all.size(), 1000U);
  for (std::size_t i = 0; i < 1000; ++i) {
    EXPECT_EQ(all[i].sample.tick, samples[i].tick);
    EXPECT_EQ(all[i].verdict, Verdict::kGood);
    EXPECT_EQ(all[i].channels, 0);
  }
}

TEST(SampleScreen, LagsByTheStuckTime) {
  SampleScreen screen{ScreenConfig{}};
  Screened out;
  int pushed = 0;
  for (const Sample& sample : moving(300)) {
    ++pushed;
    if (screen.push(sample, out)) break;
  }
  EXPECT_EQ(pushed, 80);
  EXPECT_EQ(screen.delay(), 79U);
  EXPECT_EQ(out.sample.tick, 0);
}

TEST(SampleScreen, MarksAStuckStretchFromItsFirstSampleToItsLast) {
  for (std::size_t channel = 0; channel < kChannels; ++channel) {
    auto samples = moving(1000);
    hold(samples, channel, 400, 700);
    const auto all = screened({}, samples);
    const auto stuck = with(all, Verdict::kStuck);
    ASSERT_EQ(stuck.size(), 300U);
    EXPECT_EQ(stuck.front(), 400U);
    EXPECT_EQ(stuck.back(), 699U);
    EXPECT_EQ(all[500].channels, 1U << channel);
  }
}

TEST(SampleScreen, NeedsTheFullTimeToCallAChannelStuck) {
  auto samples = moving(1000);
  hold(samples, 1, 400, 479);  // 79 equal samples
  EXPECT_TRUE(with(screened({}, samples), Verdict::kStuck).empty());
  hold(samples, 1, 400, 480);
  EXPECT_EQ(with(screened({}, samples), Verdict::kStuck).size(), 80U);
}

TEST(SampleScreen, DoesNotCallAStandstillStuck) {
  std::vector<Sample> samples = moving(3000);
  for (std::size_t i = 500; i < 2500; ++i) {
    samples[i].accel_mps2 = {0.01, 0.02 + (i % 7 == 0 ? 0.05 : 0.0), -0.03};
  }
  // The window must lie inside the standstill; where it reaches into motion, a channel that stays
  // on its value while others still move is marked, and that is the rule.
  for (const std::size_t i : with(screened({}, samples), Verdict::kStuck)) {
    EXPECT_TRUE(i < 580 || i > 2420) << i;
  }
}

TEST(SampleScreen, MeasuresMotionInStepsOfTheChannelWhereTheyAreKnown) {
  auto samples = moving(600);
  for (Sample& sample : samples) {
    sample.accel_mps2 = {0.0, 0.1 * static_cast<double>(sample.tick % 10), 0.0};  // spans 0.9
  }
  ScreenConfig config;
  config.step_mps2 = {0.2, 0.2, 0.2};  // eight steps: 1.6
  EXPECT_TRUE(with(screened(config, samples), Verdict::kStuck).empty());
  config.step_mps2 = {0.1, 0.1, 0.1};
  EXPECT_EQ(with(screened(config, samples), Verdict::kStuck).size(), 600U);
}

TEST(SampleScreen, FindsAStuckChannelThroughLostSamples) {
  std::mt19937 random{9};
  auto samples = moving(2000);
  hold(samples, 2, 500, 1500);
  std::vector<Sample> kept;
  for (const Sample& sample : samples) {
    if (random() % 100 >= 5) kept.push_back(sample);
  }
  for (const Screened& one : screened({}, kept)) {
    EXPECT_EQ(one.verdict == Verdict::kStuck, one.sample.tick >= 500 && one.sample.tick < 1500)
        << one.sample.tick;
  }
}

TEST(SampleScreen, ForgetsARunOverAPause) {
  auto samples = moving(400);
  hold(samples, 0, 150, 250);
  for (std::size_t i = 200; i < 400; ++i) samples[i].tick += 1000;  // 50 equal, a pause, 50 equal
  const auto all = screened({}, samples);
  EXPECT_EQ(all.size(), 400U);
  EXPECT_TRUE(with(all, Verdict::kStuck).empty());
}

TEST(SampleScreen, PassesOnWhatTheAssemblerSaw) {
  auto samples = moving(300);
  samples[120].saturated = 0b101;
  const auto all = screened({}, samples);
  ASSERT_EQ(with(all, Verdict::kSaturated), std::vector<std::size_t>{120});
  EXPECT_EQ(all[120].channels, 0b101);
  samples[130].spoilt = true;
  const auto spoilt = screened({}, samples);
  ASSERT_EQ(with(spoilt, Verdict::kSpoilt), std::vector<std::size_t>{130});
  EXPECT_EQ(spoilt[130].channels, 0b111);
}

TEST(SampleScreen, MarksWhatIsNotANumberAboveAllElse) {
  auto samples = moving(300);
  samples[10].accel_mps2[2] = std::numeric_limits<double>::quiet_NaN();
  samples[20].accel_mps2[1] = std::numeric_limits<double>::infinity();
  samples[20].saturated = 1;
  const auto all = screened({.find_flat_tops = true}, samples);
  EXPECT_EQ(with(all, Verdict::kNotFinite), (std::vector<std::size_t>{10, 20}));
  EXPECT_EQ(all[20].channels, 2);
}

/// A narrow-band motion with rare large peaks, clipped at a level that nobody stated.
std::vector<Sample> clipped(double level) {
  auto samples = moving(3000);
  for (std::size_t i = 300; i < samples.size(); ++i) {
    const double hit = 30.0 * std::exp(-std::abs(static_cast<double>(i % 600) - 300.0) / 8.0);
    samples[i].accel_mps2[1] = std::min(samples[i].accel_mps2[1] + hit, level);
  }
  return samples;
}

TEST(SampleScreen, FindsFlatTopsWhereTheFullScaleIsUnknown) {
  const auto samples = clipped(20.0);
  const auto all = screened({.find_flat_tops = true}, samples);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].verdict == Verdict::kSaturated, samples[i].accel_mps2[1] == 20.0) << i;
  }
  EXPECT_GT(with(all, Verdict::kSaturated).size(), 20U);
  EXPECT_TRUE(with(screened({}, samples), Verdict::kSaturated).empty());
}

TEST(SampleScreen, SeesNoFlatTopInPeaksThatAreWhole) {
  EXPECT_TRUE(with(screened({.find_flat_tops = true}, clipped(1e9)), Verdict::kSaturated).empty());
}

/// Slow beside the rate, with a coarse step: tops of several equal values, which nothing cut.
TEST(SampleScreen, SeesNoFlatTopInARoundOne) {
  auto samples = moving(3000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = static_cast<double>(i) / 1000.0;
    const double peak = i % 1400 > 1000 && i % 1400 < 1120 ? 8.0 : 0.2;
    const double value = peak * std::sin(2.0 * M_PI * t / 0.24);
    samples[i].accel_mps2[0] = 0.024 * std::round(value / 0.024);
  }
  EXPECT_TRUE(with(screened({.find_flat_tops = true}, samples), Verdict::kSaturated).empty());
  for (Sample& s : samples) s.accel_mps2[0] = std::min(s.accel_mps2[0], 0.024 * 240);
  EXPECT_GT(with(screened({.find_flat_tops = true}, samples), Verdict::kSaturated).size(), 20U);
}

TEST(SampleScreen, RefusesAConfigurationThatCannotWork) {
  EXPECT_TRUE(SampleScreen::check({}).ok());
  EXPECT_FALSE(SampleScreen::check({.sample_rate_hz = 0.0}).ok());
  EXPECT_FALSE(SampleScreen::check({.sample_rate_hz = std::nan("")}).ok());
  EXPECT_FALSE(SampleScreen::check({.moved_mps2 = 0.0}).ok());
}

}  // namespace
}  // namespace dampline

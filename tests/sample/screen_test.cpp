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

TEST(SampleScreen, WaitsAsLongAsTheRateAsksButNoLongerThanItCan) {
  for (const auto& [rate_hz, delay] :
       {std::pair{50.0, 79U}, std::pair{400.0, 79U}, std::pair{412.0, 81U}, std::pair{1000.0, 199U},
        std::pair{1400.0, 255U}})
    EXPECT_EQ(SampleScreen({.sample_rate_hz = rate_hz}).delay(), delay) << rate_hz;
}

TEST(IsNumber, IsBelowAMillion) {
  EXPECT_TRUE(is_number(-9.9e5));
  EXPECT_FALSE(is_number(1e6));
  EXPECT_FALSE(is_number(-1e6));
  EXPECT_FALSE(is_number(std::nan("")));
}

TEST(SampleScreen, AnExtraAtFullScaleSpoilsTheSample) {
  auto samples = moving(300);
  samples[100].saturated = 0b01000;
  samples[110].saturated = 0b10000;
  const auto all = screened({}, samples);
  EXPECT_EQ(with(all, Verdict::kSaturated), (std::vector<std::size_t>{100, 110}));
  EXPECT_EQ(all[100].channels, 1);
}

/// A level of +-1 to and fro, and tops of some equal values; what is marked of them.
std::size_t marked(double height, int equal, double ramp = 1.0, double step_mps2 = 0.0) {
  auto samples = moving(2000);
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i].accel_mps2[1] = i % 2 == 0 ? 1.0 : -1.0;
  for (int i = 0; i < equal; ++i)
    samples[1000 + static_cast<std::size_t>(i)].accel_mps2[1] = height;
  const std::size_t before = static_cast<std::size_t>(equal + 1) / 2;
  samples[1000 - before].accel_mps2[1] = height * (1.0 - ramp);
  ScreenConfig config{.find_flat_tops = true};
  config.step_mps2.fill(step_mps2);
  return with(screened(config, samples), Verdict::kSaturated).size();
}

TEST(SampleScreen, AFlatTopIsFourEqualValues) {
  EXPECT_EQ(marked(10.0, 3), 0U);
  EXPECT_EQ(marked(10.0, 4), 4U);
  EXPECT_EQ(marked(-10.0, 4), 4U) << "or a flat bottom";
  EXPECT_EQ(marked(10.0, 9), 9U);
}

// The values themselves move the rms of 1 to 1.06 or so.
TEST(SampleScreen, AFlatTopIsFourDeviationsAboveTheMean) {
  EXPECT_EQ(marked(3.7, 4, 1.0, 0.1), 0U);
  EXPECT_EQ(marked(4.5, 4, 1.0, 0.1), 4U);
  EXPECT_EQ(marked(-3.7, 4, 1.0, 0.1), 0U);
  EXPECT_EQ(marked(-4.5, 4, 1.0, 0.1), 4U);
}

// Six steps lie between it and the value half its length before.
TEST(SampleScreen, AFlatTopRisesSteeply) {
  EXPECT_EQ(marked(10.0, 4, 0.57, 1.0), 0U);
  EXPECT_EQ(marked(10.0, 4, 0.63, 1.0), 4U);
}

TEST(SampleScreen, ALevelThatIsKnownMarksEachValueThatReachesIt) {
  auto samples = moving(2000);
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i].accel_mps2[0] = i % 2 == 0 ? 1.0 : -1.0;
  for (std::size_t i = 1000; i < 1005; ++i) samples[i].accel_mps2[0] = 9.0;
  samples[1200].accel_mps2[0] = 9.0;
  samples[1300].accel_mps2[0] = 9.5;  // so it was none
  samples[1400].accel_mps2[0] = 9.0;
  ScreenConfig config{.find_flat_tops = true};
  config.step_mps2.fill(0.1);
  EXPECT_EQ(with(screened(config, samples), Verdict::kSaturated),
            (std::vector<std::size_t>{1000, 1001, 1002, 1003, 1004, 1200}));
}

TEST(SampleScreen, LooksForFlatTopsAfterItsWindow) {
  for (const auto& [from, found] : {std::pair{70U, false}, std::pair{90U, true}}) {
    auto samples = moving(600);
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i].accel_mps2[0] = i % 2 == 0 ? 0.5 : -0.5;
    for (std::size_t i = from; i < from + 4U; ++i) samples[i].accel_mps2[0] = 9.0;
    EXPECT_EQ(!with(screened({.find_flat_tops = true}, samples), Verdict::kSaturated).empty(),
              found);
  }
}

TEST(SampleScreen, RefusesStepsBelowNothingAndEndlessRates) {
  ScreenConfig config;
  config.step_mps2[2] = -0.1;
  EXPECT_FALSE(SampleScreen::check(config).ok());
  config.step_mps2[2] = std::nan("");
  EXPECT_FALSE(SampleScreen::check(config).ok());
  EXPECT_FALSE(SampleScreen::check({.sample_rate_hz = -1.0}).ok());
  EXPECT_FALSE(
      SampleScreen::check({.sample_rate_hz = std::numeric_limits<double>::infinity()}).ok());
  EXPECT_FALSE(SampleScreen::check({.moved_mps2 = -1.0}).ok());
}

TEST(SampleScreen, RefusesAConfigurationThatCannotWork) {
  EXPECT_TRUE(SampleScreen::check({}).ok());
  EXPECT_FALSE(SampleScreen::check({.sample_rate_hz = 0.0}).ok());
  EXPECT_FALSE(SampleScreen::check({.sample_rate_hz = std::nan("")}).ok());
  EXPECT_FALSE(SampleScreen::check({.moved_mps2 = 0.0}).ok());
}

}  // namespace
}  // namespace dampline

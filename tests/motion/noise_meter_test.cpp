// SPDX-License-Identifier: MIT
#include "dampline/motion/noise_meter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace dampline {
namespace {

constexpr int kSamples = 12000;
constexpr double kNoise = 0.02;

TEST(NoiseMeter, IsRightOnAverageForWhiteNoise) {
  double sum = 0.0;
  constexpr int kRuns = 40;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    std::mt19937_64 random{seed};
    std::normal_distribution<double> noise{0.0, kNoise};
    NoiseMeter meter;
    for (int i = 0; i < kSamples; ++i) meter.update(noise(random));
    EXPECT_NEAR(meter.std() / kNoise, 1.0, 0.35) << "seed " << seed;
    sum += meter.std() / kNoise;
  }
  EXPECT_NEAR(sum / kRuns, 1.0, 0.05);
}

/// Taps of the band around half the rate: a low pass of 0.05 under Blackman's window, turned over.
double tap(int j) {
  const double u = std::numbers::pi * j / 21.0;
  const double window = 0.42 + 0.5 * std::cos(u) + 0.08 * std::cos(2.0 * u);
  const double x = std::numbers::pi * j;
  return (j % 2 == 0 ? window : -window) * (j == 0 ? 0.1 : std::sin(0.1 * x) / x);
}

// A tone at half the rate has one magnitude behind the filter, on which the quantile settles.
TEST(NoiseMeter, StatesAToneByTheFiltersGain) {
  double gain = 0.0;
  double squares = 0.0;
  for (int j = -20; j <= 20; ++j) {
    gain += j % 2 == 0 ? tap(j) : -tap(j);
    squares += tap(j) * tap(j);
  }
  NoiseMeter meter;
  for (int i = 0; i < kSamples; ++i) meter.update(i % 2 == 0 ? kNoise : -kNoise);
  EXPECT_EQ(meter.count(), kSamples - 40);
  const double quartile = 0.31864;  // of |x| of a standard normal x
  EXPECT_NEAR(meter.std(), kNoise * gain / (quartile * std::sqrt(squares)), 0.003 * meter.std());
}

// Robbins and Monro: up by a quarter of the step, down by three quarters; a step is 4 / (n + 8) of
// the figure, and 0.002 from 1992 on.
TEST(NoiseMeter, FollowsByStepsThatShrinkToFiveHundredths) {
  NoiseMeter meter;
  const auto tone = [&](int count, double size) {
    for (int i = 0; i < count; ++i) meter.update(i % 2 == 0 ? size : -size);
  };
  tone(41, 1.0);
  ASSERT_EQ(meter.count(), 1);
  double expected = meter.std() / (1.0 - 0.5 * 0.75);  // the first is not above itself
  expected *= 1.0 - 0.5 * 0.75;
  meter.reset();
  tone(40, 1e9);
  EXPECT_EQ(meter.count(), 1) << "what follows a reset has to fill the filter";
  for (int n = 1; n < 3000; ++n) {
    meter.update(n % 2 == 0 ? -1e9 : 1e9);
    const double before = expected;
    expected *= 1.0 + 0.25 * (n < 1992 ? 4.0 / (n + 8.0) : 0.002);
    if (n % 100 < 3 || (n > 1980 && n < 2000)) {
      ASSERT_NEAR(meter.std() / expected, 1.0, 1e-9) << n;
      ASSERT_GT(meter.std(), before);
    }
  }
  meter.reset();
  tone(41, 0.0);
  EXPECT_NEAR(meter.std() / (expected * (1.0 - 0.75 * 0.002)), 1.0, 1e-9);
}

TEST(NoiseMeter, DoesNotSeeSlowMotion) {
  std::mt19937_64 random{3};
  std::normal_distribution<double> noise{0.0, kNoise};
  NoiseMeter quiet;
  NoiseMeter moving;
  for (int i = 0; i < kSamples; ++i) {
    const double x = noise(random);
    quiet.update(x);
    moving.update(x + 3.0 * std::sin(2.0 * std::numbers::pi * i * 8.0 / 300.0));
  }
  EXPECT_NEAR(moving.std() / quiet.std(), 1.0, 0.02);
}

/// Three samples of 1 m/s^2 in every 150: their rms alone is seven times the noise.
TEST(NoiseMeter, HardlyMindsBursts) {
  std::mt19937_64 random{5};
  std::normal_distribution<double> unit;
  NoiseMeter meter;
  double power = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double x = kNoise * unit(random) + (i % 150 < 3 ? unit(random) : 0.0);
    power += x * x / kSamples;
    meter.update(x);
  }
  ASSERT_GT(std::sqrt(power), 5.0 * kNoise);
  EXPECT_LT(meter.std(), 1.7 * kNoise);
}

TEST(NoiseMeter, FollowsNoiseThatGrows) {
  std::mt19937_64 random{6};
  std::normal_distribution<double> unit;
  NoiseMeter meter;
  for (int i = 0; i < kSamples; ++i) meter.update(kNoise * unit(random));
  for (int i = 0; i < kSamples; ++i) meter.update(0.1 * unit(random));
  EXPECT_NEAR(meter.std() / 0.1, 1.0, 0.35);
}

TEST(NoiseMeter, AJumpAtAResetIsNotNoise) {
  std::mt19937_64 random{7};
  std::normal_distribution<double> unit;
  NoiseMeter meter;
  for (int i = 0; i < kSamples; ++i) {
    if (i % 100 == 0) meter.reset();
    meter.update(kNoise * unit(random) + (i / 100 % 2 == 0 ? 50.0 : -50.0));
  }
  EXPECT_GT(meter.count(), kSamples / 2);
  EXPECT_NEAR(meter.std() / kNoise, 1.0, 0.35);
}

}  // namespace
}  // namespace dampline

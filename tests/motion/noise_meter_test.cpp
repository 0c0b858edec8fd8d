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

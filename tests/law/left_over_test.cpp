// SPDX-License-Identifier: MIT
#include "app/law/left_over.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

namespace dampline::app::law {
namespace {

double ratio_of(const LeftOver& left) { return left.density().value().ratio(); }

/// A motion of `share` of the rate and below. What is left: noise of 1, and `missed` of the motion.
LeftOver left_of(int samples, double share, double missed, bool gaps = false) {
  std::mt19937_64 random{3};
  std::normal_distribution<double> normal;
  LeftOver out;
  for (int i = 0; i < samples; ++i) {
    const double motion = std::sin(2.0 * std::numbers::pi * share * i) +
                          std::sin(2.0 * std::numbers::pi * 0.37 * share * i + 1.0);
    if (gaps && i % 300 == 0) out.gap();
    out.add(50.0 * motion, normal(random) + missed * motion);
  }
  return out;
}

TEST(LeftOver, TellsNoiseFromWhatALawMisses) {
  EXPECT_NEAR(ratio_of(left_of(20'000, 0.06, 0.0)), 1.0, 0.1);
  EXPECT_NEAR(ratio_of(left_of(40'000, 0.2, 0.0)), 1.0, 0.1);
  // A hundredth of the motion and a quarter of the noise: 3 % of the power that is left.
  EXPECT_GT(ratio_of(left_of(20'000, 0.06, 0.25)), 1.4);
}

TEST(LeftOver, KnowsWhereTheMotionIsThoughSegmentsDoNotMeet) {
  // Every 300 samples the law starts anew where it has come to miss a tenth of the motion.
  LeftOver out;
  std::mt19937_64 random{3};
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20'000; ++i) {
    const double motion = 50.0 * std::sin(2.0 * std::numbers::pi * 0.005 * i);
    const double missed = 5.0 * (static_cast<double>(i % 300) / 300.0);
    out.add(motion + missed, normal(random) + missed);
  }
  EXPECT_GT(ratio_of(out), 10.0);
}

TEST(LeftOver, KnowsHowNoisyItIsBesideTonesUpToAThirdOfTheRate) {
  std::mt19937_64 random{3};
  std::normal_distribution<double> normal;
  LeftOver out;
  for (int i = 0; i < 20'000; ++i) {
    double tones = 0.0;
    for (int k = 1; k <= 33; ++k)
      tones += std::sin(2.0 * std::numbers::pi * 0.01 * k * i + static_cast<double>(k * k));
    out.add(0.0, 20.0 * tones + 0.5 * normal(random));
  }
  EXPECT_NEAR(std::sqrt(out.quietest()), 0.5, 0.03);
}

TEST(LeftOver, SaysNothingWhereItCannotTell) {
  EXPECT_FALSE(left_of(2'000, 0.06, 0.0).density().has_value());  // too short
  EXPECT_FALSE(left_of(20'000, 0.4, 0.0).density().has_value());  // nothing beside the motion
  EXPECT_FALSE(left_of(20'000, 0.06, 0.0, true).density().has_value());  // no 512 samples in a row
  LeftOver nothing;
  for (int i = 0; i < 20'000; ++i) nothing.add(std::sin(0.2 * i), 0.0);
  EXPECT_FALSE(nothing.density().has_value());
}

}  // namespace
}  // namespace dampline::app::law

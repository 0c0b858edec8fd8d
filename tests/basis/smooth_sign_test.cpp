// SPDX-License-Identifier: MIT
#include "dampline/basis/smooth_sign.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/steps.hpp"

namespace dampline {
namespace {

TEST(ErfTable, IsErfWithin2Millionths) {
  double worst = 0.0;
  for (const double x : steps(-5.0, 5.0, 1.37e-5))
    worst = std::max(worst, std::abs(erf_table(x) - std::erf(x)));
  EXPECT_LT(worst, 2e-6);
}

TEST(ErfTable, IsOddAndZeroAtZero) {
  EXPECT_EQ(erf_table(0.0), 0.0);
  for (const double x : steps(0.0, 6.0, 0.0137)) EXPECT_EQ(erf_table(-x), -erf_table(x));
}

TEST(ErfTable, NeverDecreases) {
  double last = -1.0;
  for (const double x : steps(-5.0, 5.0, 0.0011)) {
    EXPECT_GE(erf_table(x), last);
    last = erf_table(x);
  }
}

TEST(ErfTable, TakesAnythingForAnArgument) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(erf_table(infinity), 1.0);
  EXPECT_EQ(erf_table(-infinity), -1.0);
  EXPECT_EQ(erf_table(1e300), 1.0);
  EXPECT_EQ(erf_table(std::nextafter(4.0, 0.0)), erf_table(4.0));
  EXPECT_LE(std::abs(erf_table(std::numeric_limits<double>::quiet_NaN())), 1.0);
  EXPECT_NEAR(erf_table(std::numeric_limits<double>::denorm_min()), 0.0, 1e-300);
}

TEST(SmoothSign, HasSlopeOneOverItsWidth) {
  for (const double width_mps : {0.5e-3, 2e-3, 11e-3}) {
    const double v = 1e-3 * width_mps;
    EXPECT_NEAR(smooth_sign(v, width_mps) / v * width_mps, 1.0, 1e-4);
  }
}

/// It is the expected sign of a velocity with a Gaussian error.
TEST(SmoothSign, IsTheMeanSignOfANoisyVelocity) {
  std::mt19937_64 random{1};
  const double width_mps = 2e-3;
  // erf(x / (sqrt(2) s)) is the mean sign of x + s noise.
  std::normal_distribution<double> noise{0.0, width_mps / (std::sqrt(2.0) * kSignSlope)};
  for (const double v : {0.5e-3, 1e-3, 3e-3}) {
    double sum = 0.0;
    constexpr int kDraws = 200000;
    for (int i = 0; i < kDraws; ++i) sum += v + noise(random) > 0.0 ? 1.0 : -1.0;
    EXPECT_NEAR(smooth_sign(v, width_mps), sum / kDraws, 0.01);
  }
}

}  // namespace
}  // namespace dampline

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dampline/damping/estimator.hpp"
#include "dampline/wavelet/row_builder.hpp"

namespace dampline {
namespace {

constexpr double kStepS = 1.0 / 300.0;
const LawColumns law_columns{kDefaultCurveNodesMps};

/// A cubic over time that crosses zero at some 2 mm/s per sample: the interpolation is exact.
struct Cubic {
  double a, b, c, d;
  [[nodiscard]] double velocity(double t) const { return a + t * (b + t * (c + t * d)); }
  [[nodiscard]] double accel(double t) const { return b + t * (2.0 * c + 3.0 * t * d); }
};
constexpr Cubic kMotion{-0.012, 0.6, 4.0, -150.0};

/// Average by a hat of two samples' width around t, by `per_sample` points a sample.
LawColumns::Values hat_average(double t, int per_sample) {
  LawColumns::Values sum = LawColumns::Values::Zero();
  for (int i = -per_sample + 1; i < per_sample; ++i) {
    const double u = static_cast<double>(i) / per_sample;
    sum += (1.0 - std::abs(u)) / per_sample * law_columns(kMotion.velocity(t + u * kStepS));
  }
  return sum;
}

template <class Check>
void for_each_average(const Check& check) {
  LawAverage average;
  int seen = 0;
  for (int n = 0; n < 20; ++n) {
    const double t = n * kStepS;
    const LawColumns::Values values = LawColumns::values(
        average.update(law_columns, kMotion.velocity(t), kMotion.accel(t), kStepS));
    EXPECT_EQ(average.complete(), n >= 2);
    if (!average.complete()) continue;
    check(t - kStepS, values);
    ++seen;
  }
  EXPECT_EQ(seen, 18);
}

TEST(LawAverage, IsTheHatAverageOverFourPointsASample) {
  for_each_average([](double t, const LawColumns::Values& values) {
    EXPECT_LT((values - hat_average(t, 4)).cwiseAbs().maxCoeff(), 3e-7) << t;  // single precision
  });
}

TEST(LawAverage, IsCloseToTheTrueHatAverage) {
  for_each_average([](double t, const LawColumns::Values& values) {
    const LawColumns::Values truth = hat_average(t, 200);
    for (std::size_t i = 0; i < kLawWidths; ++i) {
      // Four points resolve a sign that is about as wide as the step between them, 0.5 mm/s.
      const double tolerance = kLawWidthMps[i] < 0.9e-3 ? 0.03 : 8e-3;
      EXPECT_NEAR(values[static_cast<int>(i)], truth[static_cast<int>(i)], tolerance) << i;
    }
    for (int i = static_cast<int>(kLawWidths); i < LawColumns::kCount; ++i)
      EXPECT_NEAR(values[i], truth[i], 3e-5) << i;
  });
}

/// On the samples alone the narrow signs would be wrong by tens of percent at a reversal.
TEST(LawAverage, DiffersFromTheLawOnTheSamplesAlone) {
  double largest = 0.0;
  for_each_average([&](double t, const LawColumns::Values& values) {
    largest = std::max(largest, std::abs(values[0] - law_columns(kMotion.velocity(t))[0]));
  });
  EXPECT_GT(largest, 0.1);
}

TEST(LawAverage, StartsCleanAfterAReset) {
  LawAverage used;
  for (int n = 0; n < 7; ++n) used.update(law_columns, 0.05, -3.0, kStepS);
  used.reset();
  LawAverage fresh;
  for (int n = 0; n < 10; ++n) {
    const double t = n * kStepS;
    const auto a = used.update(law_columns, kMotion.velocity(t), kMotion.accel(t), kStepS);
    const auto b = fresh.update(law_columns, kMotion.velocity(t), kMotion.accel(t), kStepS);
    ASSERT_EQ(used.complete(), fresh.complete());
    if (fresh.complete()) {
      EXPECT_EQ((a - b).abs().maxCoeff(), 0.0F) << n;
    }
  }
}

}  // namespace
}  // namespace dampline

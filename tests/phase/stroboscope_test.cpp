// SPDX-License-Identifier: MIT
#include "dampline/phase/stroboscope.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace dampline {
namespace {

constexpr double kPeriodS = 0.371;
constexpr double kRate = 2.0 * std::numbers::pi / kPeriodS;

PhasePoint sinusoid(double time_s) {
  return {std::sin(kRate * time_s), kRate * std::cos(kRate * time_s),
          -kRate * kRate * std::sin(kRate * time_s)};
}

std::vector<SectionPoint> look(Stroboscope& stroboscope, double from_s, double to_s) {
  std::vector<SectionPoint> out;
  for (int i = static_cast<int>(from_s * 300.0); i < static_cast<int>(to_s * 300.0); ++i) {
    const double t = i / 300.0;
    const SectionPoint p = stroboscope.update(t, sinusoid(t));
    if (p.taken) out.push_back(p);
  }
  return out;
}

TEST(Stroboscope, MeetsASinusoidAtTheSamePointsEachPeriod) {
  Stroboscope s = Stroboscope::make({kPeriodS, 0.1, 4}, 0.01).value();
  const auto points = look(s, -20.0, 20.0);
  ASSERT_NEAR(static_cast<double>(points.size()), 4.0 * 40.0 / kPeriodS, 1.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PhasePoint truth = sinusoid(0.1 + points[i].phase * kPeriodS / 4.0);
    EXPECT_NEAR(points[i].point.deflection_m, truth.deflection_m, 1e-6);
    EXPECT_NEAR(points[i].point.velocity_mps, truth.velocity_mps, 1e-6 * kRate);
    EXPECT_NEAR(points[i].point.accel_mps2, truth.accel_mps2, 5e-4 * kRate * kRate);
    if (i > 0) {
      EXPECT_EQ(points[i].phase, (points[i - 1].phase + 1) % 4);
    }
  }
}

TEST(Stroboscope, PassesOverFlashesInAGap) {
  Stroboscope s = Stroboscope::make({kPeriodS, 0.0, 1}, 0.01).value();
  const std::size_t before = look(s, 0.1, 1.0).size();
  const auto after = look(s, 3.0, 4.0);
  EXPECT_EQ(before, 2U);
  ASSERT_FALSE(after.empty());
  EXPECT_GT(after.front().time_s, 3.0);
}

TEST(Stroboscope, StartsAfreshAfterWhatIsNoNumberAndAfterTimeThatStandsStill) {
  Stroboscope s = Stroboscope::make({1.0, 0.0, 1}, 0.5).value();
  EXPECT_FALSE(s.update(0.9, {}).taken);
  EXPECT_FALSE(s.update(1.1, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}).taken);
  EXPECT_FALSE(s.update(1.2, {}).taken);
  EXPECT_FALSE(s.update(0.9, {}).taken);
  EXPECT_TRUE(s.update(1.1, {}).taken);
}

TEST(MovingSigmas, LetOneStuckPointIn26MillionPass) {
  EXPECT_NEAR(std::erfc(kMovingSigmas / std::sqrt(2.0)) * 26e6, 1.0, 0.02);
}

TEST(Stroboscope, RefusesWhatIsNoPeriod) {
  EXPECT_FALSE(Stroboscope::make({0.0, 0.0, 1}, 0.1).ok());
  EXPECT_FALSE(Stroboscope::make({std::numeric_limits<double>::infinity(), 0.0, 1}, 0.1).ok());
  EXPECT_FALSE(Stroboscope::make({1.0, 0.0, 0}, 0.1).ok());
}

}  // namespace
}  // namespace dampline

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

#include "dampline/effect/rows.hpp"

namespace dampline::effect {
namespace {

/// Rows of friction 2 and a spring of 30, whose residual is one either way; now and then larger.
class Residuals {
 public:
  void rows(int count, const std::set<std::int64_t>& at = {}, double size = 20.0) {
    for (int i = 0; i < count; ++i, ++tick_) {
      const double friction = tick_ / 2 % 2 == 0 ? 1.0 : -1.0;
      const double spring = tick_ / 4 % 2 == 0 ? 0.1 : -0.1;
      const double residual = (tick_ % 2 == 0 ? 1.0 : -1.0) * (at.contains(tick_) ? size : 1.0);
      Row row = Row::Zero();
      row[kSign + 3] = static_cast<float>(friction);
      row[kFrameTwice] = static_cast<float>(0.75 * spring);
      row[kWheelset1Twice] = static_cast<float>(0.25 * spring);
      row[kWheelset2Twice] = static_cast<float>(0.25 * spring);
      row[kTarget] = static_cast<float>(2.0 * friction + 30.0 * spring + residual);
      meter_.update(tick_, row);
    }
  }
  [[nodiscard]] const ImpulseMeter& meter() const { return meter_; }

 private:
  ImpulseMeter meter_;
  std::int64_t tick_{0};
};

TEST(ImpulseMeter, FindsNothingInAnOrdinaryResidual) {
  Residuals residuals;
  residuals.rows(5000);
  EXPECT_EQ(residuals.meter().events(), 0U);
  EXPECT_EQ(residuals.meter().share(), 0.0);
  EXPECT_EQ(residuals.meter().rows(), 5000U);
}

// The first 400 rows tell friction and spring, the next 400 what is usual.
TEST(ImpulseMeter, JudgesFromTheEightHundredthRowOn) {
  for (const auto& [tick, events] : {std::pair{798, 0U}, std::pair{799, 1U}}) {
    Residuals residuals;
    residuals.rows(3000, {tick});
    EXPECT_EQ(residuals.meter().events(), events) << tick;
  }
}

// Six deviations of a normal residual whose median is one: 8.9.
TEST(ImpulseMeter, CountsWhatIsSixDeviationsLarge) {
  for (const auto& [size, events] : {std::pair{8.4, 0U}, std::pair{9.4, 1U}}) {
    Residuals residuals;
    residuals.rows(6000, {5000}, size);
    EXPECT_EQ(residuals.meter().events(), events) << size;
  }
}

TEST(ImpulseMeter, EventsAreFortyFiveSamplesApart) {
  const auto events = [](const std::set<std::int64_t>& at) {
    Residuals residuals;
    residuals.rows(3000, at);
    return residuals.meter().events();
  };
  EXPECT_EQ(events({2000, 2044}), 1U);
  EXPECT_EQ(events({2000, 2045}), 2U);
  EXPECT_EQ(events({2000, 2040, 2080, 2120}), 1U) << "one that goes on";
}

// Of 4201 squares that are judged, ten of 400 and the rest of one.
TEST(ImpulseMeter, MeasuresTheShareOfTheEnergy) {
  Residuals residuals;
  std::set<std::int64_t> at;
  for (std::int64_t tick = 1000; tick < 4000; tick += 300) at.insert(tick);
  residuals.rows(5000, at);
  EXPECT_EQ(residuals.meter().events(), 10U);
  EXPECT_NEAR(residuals.meter().share(), 4000.0 / (4000.0 + 4191.0), 0.01);
}

}  // namespace
}  // namespace dampline::effect

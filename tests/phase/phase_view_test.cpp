// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "dampline/phase/view.hpp"
#include "sim_hw/noise.hpp"

namespace dampline {
namespace {

constexpr double kStepS = 1.0 / 300.0;
constexpr double kAmplitudeM = 1e-3;

Motion sinusoid(std::int64_t tick, double period_s) {
  const double w = 2.0 * std::numbers::pi / period_s;
  const double angle = w * kStepS * static_cast<double>(tick);
  return {.tick = tick,
          .deflection_m = kAmplitudeM * std::sin(angle),
          .velocity_mps = kAmplitudeM * w * std::cos(angle),
          .relative_mps2 = -kAmplitudeM * w * w * std::sin(angle)};
}

struct View {
  explicit View(const PhaseViewConfig& config = {})
      : view{std::make_unique<PhaseView>(PhaseView::check(config).value())} {}
  std::unique_ptr<PhaseView> view;
  std::unique_ptr<PhaseSnapshot> snapshot() const {
    auto out = std::make_unique<PhaseSnapshot>();
    view->snapshot(*out);
    return out;
  }
};

double mass(const PhasePicture& p) {
  double sum = 0.0;
  for (const auto& column : p.density)
    for (const float d : column) sum += static_cast<double>(d);
  const double cell = (p.x_high - p.x_low) * (p.y_high - p.y_low) / (kPictureCells * kPictureCells);
  return sum * cell;
}

TEST(PhaseView, ShowsASinusoidAsThreePlanesAndFourPoints) {
  View v;
  for (int i = 0; i < 60000; ++i) v.view->update(sinusoid(i, 0.371));
  const auto s = v.snapshot();
  EXPECT_EQ(s->velocity_over_deflection.state, PictureState::kGood);
  EXPECT_NEAR(mass(s->velocity_over_deflection), 1.0, 1e-5);
  EXPECT_NEAR(mass(s->accel_over_velocity), 1.0, 1e-5);
  EXPECT_EQ(s->velocity_over_deflection.outside_share, 0.0);
  ASSERT_EQ(s->period.state, PeriodState::kFound);
  EXPECT_NEAR(s->period.period_s, 0.371, 4e-5);
  for (std::size_t phase = 0; phase < kSectionPhases; ++phase) {
    ASSERT_EQ(s->section_count[phase], kSectionPoints);
    for (const PhasePoint& p : s->section[phase])  // a drift of a twentieth of a period at most
      EXPECT_NEAR(p.deflection_m, s->section[phase][0].deflection_m, 0.32 * kAmplitudeM);
  }
}

// The acceleration of a sinusoid is a straight line over the deflection.
TEST(PhaseView, PutsTheMassWhereTheMotionIs) {
  View v{{.deflection_low_m = -2e-3,
          .deflection_high_m = 2e-3,
          .velocity_low_mps = -0.05,
          .velocity_high_mps = 0.05,
          .accel_low_mps2 = -2.0,
          .accel_high_mps2 = 2.0}};
  for (int i = 0; i < 30000; ++i) v.view->update(sinusoid(i, 0.371));
  const auto s = v.snapshot();
  const PhasePicture& p = s->accel_over_deflection;
  const double slope = -std::pow(2.0 * std::numbers::pi / 0.371, 2);
  for (std::size_t i = 0; i < kPictureCells; ++i) {
    for (std::size_t j = 0; j < kPictureCells; ++j) {
      if (!(p.density[i][j] > 0.0F)) continue;
      const double y = -2e-3 + (static_cast<double>(i) + 0.5) * 4e-3 / kPictureCells;
      const double a = -2.0 + (static_cast<double>(j) + 0.5) * 4.0 / kPictureCells;
      EXPECT_NEAR(a, slope * y,
                  0.5 * 4.0 / kPictureCells + 0.5 * -slope * 4e-3 / kPictureCells + 1e-12);
    }
  }
}

TEST(PhaseView, FindsNoPeriodInNoiseAndGivesNoSections) {
  View v;
  sim::Random random{1, sim::Stream::kTrack};
  for (int i = 0; i < 60000; ++i)
    v.view->update({.tick = i,
                    .deflection_m = 1e-3 * random.normal(),
                    .velocity_mps = 1e-2 * random.normal(),
                    .relative_mps2 = random.normal()});
  const auto s = v.snapshot();
  EXPECT_EQ(s->period.state, PeriodState::kNone);
  EXPECT_EQ(s->period.period_s, 0.0);
  for (const std::size_t n : s->section_count) EXPECT_EQ(n, 0U);
}

TEST(PhaseView, SaysThatAGivenPeriodIsNotThere) {
  View wrong{{.known_period_s = 0.29}};
  View right{{.known_period_s = 0.371}};
  for (int i = 0; i < 60000; ++i) {
    wrong.view->update(sinusoid(i, 0.371));
    right.view->update(sinusoid(i, 0.371));
  }
  EXPECT_EQ(wrong.snapshot()->period.state, PeriodState::kNone);
  EXPECT_EQ(wrong.snapshot()->section_count[0], 0U);
  const auto s = right.snapshot();
  EXPECT_TRUE(s->period_is_known);
  EXPECT_EQ(s->period.state, PeriodState::kFound);
  for (const PhasePoint& p : s->section[1])
    EXPECT_NEAR(p.deflection_m, s->section[1][0].deflection_m, 1e-5 * kAmplitudeM);
}

TEST(PhaseView, SaysNoMotionOnAStillRecord) {
  View v;
  View standing;
  for (int i = 0; i < 30000; ++i) {
    v.view->update({.tick = i});
    standing.view->update({.tick = i, .velocity_mps = 1e-7 * (i % 2), .still = true});
  }
  EXPECT_EQ(v.snapshot()->period.state, PeriodState::kNoMotion);
  EXPECT_EQ(v.snapshot()->velocity_over_deflection.state, PictureState::kConstant);
  EXPECT_EQ(standing.snapshot()->velocity_over_deflection.state, PictureState::kEmpty);
  EXPECT_EQ(standing.snapshot()->still, 30000U);
}

TEST(PhaseView, NamesAConstantChannel) {
  for (double Motion::*constant :
       {&Motion::deflection_m, &Motion::velocity_mps, &Motion::relative_mps2}) {
    View v;
    for (int i = 0; i < 30000; ++i) {
      Motion m = sinusoid(i, 0.371);
      m.*constant = 2e-4;
      v.view->update(m);
    }
    const auto state_unless = [&](double Motion::*x, double Motion::*y) {
      return x == constant || y == constant ? PictureState::kConstant : PictureState::kGood;
    };
    const auto s = v.snapshot();
    EXPECT_EQ(s->velocity_over_deflection.state,
              state_unless(&Motion::deflection_m, &Motion::velocity_mps));
    EXPECT_EQ(s->accel_over_deflection.state,
              state_unless(&Motion::deflection_m, &Motion::relative_mps2));
    EXPECT_EQ(s->accel_over_velocity.state,
              state_unless(&Motion::velocity_mps, &Motion::relative_mps2));
  }
}

// |sin| exceeds cos(0.1 pi) for a fifth of the time.
TEST(PhaseView, SaysThatARangeClipsAFifthOfTheMass) {
  const double limit = kAmplitudeM * std::cos(0.1 * std::numbers::pi);
  View v{{.deflection_low_m = -limit, .deflection_high_m = limit}};
  for (int i = 0; i < 30000; ++i) v.view->update(sinusoid(i, 0.371));
  const auto s = v.snapshot();
  EXPECT_EQ(s->velocity_over_deflection.state, PictureState::kClipped);
  EXPECT_NEAR(s->velocity_over_deflection.outside_share, 0.2, 0.002);
  EXPECT_EQ(s->accel_over_velocity.state, PictureState::kGood);
}

TEST(PhaseView, GoesOnAfterGapsAndCountsWhatIsNoNumber) {
  View v;
  for (int i = 0; i < 90000; ++i) {
    Motion m = sinusoid(i + 777 * (i / 20000), 0.371);
    if (i % 10000 == 5) m.velocity_mps = std::numeric_limits<double>::quiet_NaN();
    v.view->update(m);
  }
  EXPECT_EQ(v.snapshot()->not_finite, 9U);
  EXPECT_EQ(v.snapshot()->period.state, PeriodState::kFound);
  EXPECT_NEAR(v.snapshot()->period.period_s, 0.371, 1e-4);
}

TEST(PhaseView, RefusesNonsense) {
  EXPECT_FALSE(PhaseView::check({.sample_rate_hz = 0.0}).ok());
  EXPECT_FALSE(PhaseView::check({.deflection_low_m = 1.0, .deflection_high_m = -1.0}).ok());
  EXPECT_FALSE(PhaseView::check({.learn_s = 0.0}).ok());
  EXPECT_FALSE(PhaseView::check({.known_period_s = 0.001}).ok());
}

}  // namespace
}  // namespace dampline

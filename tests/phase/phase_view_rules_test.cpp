// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "dampline/phase/view.hpp"

namespace dampline {
namespace {

TEST(PhaseViewRules, HasItsLimits) {
  const auto ok = [](const PhaseViewConfig& config) { return PhaseView::check(config).ok(); };
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(ok({}));
  EXPECT_TRUE(ok({.sample_rate_hz = 0.4}));
  EXPECT_FALSE(ok({.sample_rate_hz = infinite}));
  EXPECT_FALSE(ok({.sample_rate_hz = -1.0}));
  EXPECT_TRUE(ok({.learn_s = 0.4}));
  EXPECT_FALSE(ok({.learn_s = 1e6}));
  EXPECT_FALSE(ok({.learn_s = std::nan("")}));
  EXPECT_TRUE(ok({.known_period_s = 8.01 / 300.0})) << "eight samples";
  EXPECT_FALSE(ok({.known_period_s = 7.99 / 300.0}));
  EXPECT_FALSE(ok({.sample_rate_hz = 256.0, .known_period_s = 8.0 / 256.0})) << "more than eight";
  EXPECT_FALSE(ok({.known_period_s = -1.0}));
  EXPECT_FALSE(ok({.known_period_s = infinite}));
  EXPECT_FALSE(ok({.velocity_low_mps = 1.0, .velocity_high_mps = -1.0}));
  EXPECT_FALSE(ok({.accel_low_mps2 = 1.0, .accel_high_mps2 = -1.0}));
}

/// A circle in all planes.
Motion at_angle(std::int64_t tick, double angle) {
  return {.tick = tick,
          .deflection_m = 1e-3 * std::sin(angle),
          .velocity_mps = 1e-2 * std::cos(angle),
          .relative_mps2 = std::cos(angle + 0.7)};
}
Motion on_circle(std::int64_t tick, double period_s) {
  return at_angle(tick, 2.0 * std::numbers::pi * static_cast<double>(tick) / 300.0 / period_s);
}

std::unique_ptr<PhaseSnapshot> snapshot_of(const PhaseView& view) {
  auto out = std::make_unique<PhaseSnapshot>();
  view.snapshot(*out);
  return out;
}

constexpr PhaseViewConfig kRanges{.deflection_low_m = -2e-3,
                                  .deflection_high_m = 2e-3,
                                  .velocity_low_mps = -0.02,
                                  .velocity_high_mps = 0.02,
                                  .accel_low_mps2 = -2.0,
                                  .accel_high_mps2 = 2.0};

TEST(PhaseViewRules, APictureIsClippedFromOnePercentOn) {
  for (const auto& [outside, state] :
       {std::pair{10, PictureState::kGood}, std::pair{11, PictureState::kClipped}}) {
    const auto view = std::make_unique<PhaseView>(kRanges);
    for (int i = 0; i < 1000; ++i) {
      Motion motion = on_circle(i, 0.4);
      if (i % 90 == 0 && i / 90 < outside) motion.deflection_m = 5e-3;
      view->update(motion);
    }
    EXPECT_EQ(snapshot_of(*view)->velocity_over_deflection.state, state) << outside;
    EXPECT_EQ(snapshot_of(*view)->accel_over_velocity.state, PictureState::kGood);
    EXPECT_EQ(snapshot_of(*view)->velocity_over_deflection.samples, 1000U);
    EXPECT_EQ(snapshot_of(*view)->velocity_over_deflection.x_high, 2e-3);
    EXPECT_EQ(snapshot_of(*view)->velocity_over_deflection.y_low, -0.02);
  }
}

// The middle of each cell, once.
TEST(PhaseViewRules, APictureShowsEveryCellAlike) {
  const auto view = std::make_unique<PhaseView>(kRanges);
  const auto middle = [](std::int64_t cell) {
    return (static_cast<double>(cell) + 0.5) / kPictureCells - 0.5;
  };
  constexpr auto kCells = static_cast<std::int64_t>(kPictureCells);
  for (std::int64_t tick = 0; tick < kCells * kCells; ++tick)
    view->update({.tick = tick,
                  .deflection_m = 4e-3 * middle(tick / kCells),
                  .velocity_mps = 0.04 * middle(tick % kCells),
                  .relative_mps2 = 4.0 * middle(tick % kCells)});
  const auto out = snapshot_of(*view);
  for (std::size_t i = 0; i < kPictureCells; ++i) {
    for (std::size_t j = 0; j < kPictureCells; ++j) {
      ASSERT_NEAR(out->velocity_over_deflection.density[i][j] * 4e-3 * 0.04, 1.0, 1e-3);
      ASSERT_NEAR(out->accel_over_deflection.density[i][j] * 4e-3 * 4.0, 1.0, 1e-3);
      ASSERT_EQ(out->accel_over_velocity.density[i][j] > 0.0F, i == j);
    }
  }
}

// At 50 samples a second a tenth of a second is five of them.
TEST(PhaseViewRules, FindsATenthOfASecondAtFiftySamplesASecond) {
  PhaseViewConfig config = kRanges;
  config.sample_rate_hz = 50.0;
  const auto view = std::make_unique<PhaseView>(config);
  for (std::int64_t tick = 0; tick < 10'000; ++tick) view->update(on_circle(tick, 6.0 / 300.0));
  const Period period = snapshot_of(*view)->period;
  EXPECT_EQ(period.state, PeriodState::kFound);
  EXPECT_NEAR(period.period_s, 6.0 / 50.0, 1e-4);
}

TEST(PhaseViewRules, LooksForAPeriodEveryTenSeconds) {
  const auto view = std::make_unique<PhaseView>(kRanges);
  const auto points = [&] { return snapshot_of(*view)->section_count[0]; };
  std::int64_t tick = 0;
  const auto run = [&](double seconds, double period_s) {
    for (int i = 0; i < static_cast<int>(seconds * 300.0); ++i)
      view->update(on_circle(tick++, period_s));
  };
  run(119.9, 0.373);  // of a tone 9 * 512 products of 20 ms are sure
  EXPECT_NEAR(static_cast<double>(points()), 9.9 / 0.373, 2.0);
  const std::size_t before = points();
  const double first_m = on_circle(110 * 300 - 1, 0.373).deflection_m;
  EXPECT_NEAR(snapshot_of(*view)->section[0][0].deflection_m, first_m, 1e-4) << "from there on";
  run(10.0, 0.373);
  EXPECT_NEAR(static_cast<double>(points() - before), 27.0, 2.0) << "four points a period";
}

// The period that is found goes from 0.371 s towards 0.3725 s: by half a minute flashes would have
// drifted by more than a twentieth of it.
TEST(PhaseViewRules, BeginsSectionsAnewWhereThePeriodHasMoved) {
  const auto view = std::make_unique<PhaseView>(kRanges);
  double angle = 0.0;
  std::int64_t tick = 0;
  const auto run = [&](double seconds, double period_s) {
    for (int i = 0; i < static_cast<int>(seconds * 300.0); ++i, ++tick) {
      angle += 2.0 * std::numbers::pi / 300.0 / period_s;
      view->update(at_angle(tick, angle));
    }
  };
  run(120.0, 0.371);
  run(60.0, 0.3725);
  const auto out = snapshot_of(*view);
  EXPECT_EQ(out->period.state, PeriodState::kFound);
  EXPECT_GT(out->section_count[0], 10U);
  EXPECT_LT(out->section_count[0], 120U) << "of some 188 since they began";
}

TEST(PhaseViewRules, EndsTheSectionsWhereThePeriodIsGoneAndBeginsAnewWhereItIsBack) {
  const auto view = std::make_unique<PhaseView>(kRanges);
  std::int64_t tick = 0;
  for (; tick < 45'000; ++tick) view->update(on_circle(tick, 0.371));
  EXPECT_GT(snapshot_of(*view)->section_count[2], 50U);
  std::uint64_t state = 1;
  for (; tick < 90'000; ++tick) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    const double noise = static_cast<double>(state >> 40U) / 16777216.0 - 0.5;
    view->update({.tick = tick,
                  .deflection_m = 1e-3 * noise,
                  .velocity_mps = 0.2 * noise,
                  .relative_mps2 = noise});
  }
  EXPECT_EQ(snapshot_of(*view)->period.state, PeriodState::kNone);
  for (; tick < 90'100; ++tick) view->update(on_circle(tick, 0.371));
  for (const std::size_t count : snapshot_of(*view)->section_count) EXPECT_EQ(count, 0U);
  for (; tick < 400'000; ++tick) {
    if (tick % 3000 == 0 && snapshot_of(*view)->section_count[1] >= 100) break;
    view->update(on_circle(tick, 0.371));
  }
  const auto back = snapshot_of(*view);
  ASSERT_EQ(back->period.state, PeriodState::kFound);
  ASSERT_GE(back->section_count[1], 100U);
  for (std::size_t i = 0; i < back->section_count[1]; ++i) {
    const PhasePoint& p = back->section[1][i];
    EXPECT_NEAR(std::hypot(p.deflection_m / 1e-3, p.velocity_mps / 1e-2), 1.0, 0.05) << i;
  }
}

TEST(PhaseViewRules, TwoColumnsAndTwoRowsVary) {
  const auto view = std::make_unique<PhaseView>(kRanges);
  for (std::int64_t tick = 0; tick < 100; ++tick) {
    const double sign = tick % 2 == 0 ? 1.0 : -1.0;
    view->update({.tick = tick, .deflection_m = 1e-3 * sign, .velocity_mps = 0.01 * sign});
  }
  EXPECT_EQ(snapshot_of(*view)->velocity_over_deflection.state, PictureState::kGood);
  EXPECT_EQ(snapshot_of(*view)->accel_over_deflection.state, PictureState::kConstant);
}

TEST(PhaseViewRules, APictureOfNoSampleIsEmptyWhateverWasThere) {
  const auto full = std::make_unique<PhaseView>(kRanges);
  for (std::int64_t tick = 0; tick < 3000; ++tick) full->update(on_circle(tick, 0.4));
  const auto out = snapshot_of(*full);
  EXPECT_EQ(out->accel_over_deflection.state, PictureState::kGood);
  std::make_unique<PhaseView>(kRanges)->snapshot(*out);
  EXPECT_EQ(out->accel_over_deflection.state, PictureState::kEmpty);
  EXPECT_EQ(out->accel_over_deflection.samples, 0U);
}

TEST(PhaseViewRules, SectionsOfAKnownPeriodBeginAtOnceAndHoldTheNewest) {
  PhaseViewConfig config = kRanges;
  config.known_period_s = 0.4;
  const auto view = std::make_unique<PhaseView>(config);
  for (std::int64_t tick = 0; tick < 3000; ++tick) view->update(on_circle(tick, 0.4));
  const auto early = snapshot_of(*view);
  EXPECT_EQ(early->period.state, PeriodState::kNotEnough);
  for (std::size_t phase = 0; phase < kSectionPhases; ++phase) {
    EXPECT_NEAR(static_cast<double>(early->section_count[phase]), 25.0, 1.0);
    const double angle = 0.5 * std::numbers::pi * static_cast<double>(phase);
    EXPECT_NEAR(early->section[phase][3].deflection_m, 1e-3 * std::sin(angle), 1e-5);
  }
  for (std::int64_t tick = 3000; tick < 60'000; ++tick) {
    Motion motion = on_circle(tick, 0.4);
    motion.relative_mps2 = static_cast<double>(tick);
    view->update(motion);
  }
  const auto late = snapshot_of(*view);
  EXPECT_EQ(late->section_count[1], kSectionPoints);
  EXPECT_NEAR(late->section[1][kSectionPoints - 1].accel_mps2, 60'000.0, 125.0);
  EXPECT_NEAR(late->section[1][0].accel_mps2, 60'000.0 - 120.0 * 199.0, 250.0);
}

// Whatever the unit of time is.
TEST(PhaseViewRules, SectionsDependOnSamplesAPeriodAlone) {
  for (const double rate_hz : {300.0, 0.25}) {
    PhaseViewConfig config = kRanges;
    config.sample_rate_hz = rate_hz;
    config.known_period_s = 120.0 / rate_hz;
    const auto view = std::make_unique<PhaseView>(config);
    for (std::int64_t tick = 0; tick < 1201; ++tick) view->update(on_circle(tick, 0.4));
    for (std::size_t phase = 0; phase < kSectionPhases; ++phase)
      EXPECT_NEAR(static_cast<double>(snapshot_of(*view)->section_count[phase]), 10.0, 1.0);
  }
}

TEST(PhaseViewRules, WhatIsNoNumberIsInNoPictureAndJoinsNothing) {
  PhaseViewConfig config = kRanges;
  config.known_period_s = 0.4;
  const auto view = std::make_unique<PhaseView>(config);
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (std::int64_t tick = 0; tick < 3000; ++tick) {
    Motion motion = on_circle(tick, 0.4);
    if (tick % 30 == 0 && tick % 120 != 0) {  // at three flashes of four
      double& value = tick % 120 == 30   ? motion.deflection_m
                      : tick % 120 == 60 ? motion.velocity_mps
                                         : motion.relative_mps2;
      value = none;
    }
    view->update(motion);
  }
  const auto out = snapshot_of(*view);
  EXPECT_EQ(out->not_finite, 75U);
  for (const PhasePicture* picture :
       {&out->velocity_over_deflection, &out->accel_over_deflection, &out->accel_over_velocity}) {
    EXPECT_EQ(picture->samples, 2925U);
    EXPECT_EQ(picture->outside_share, 0.0);
  }
  EXPECT_GT(out->section_count[0], 20U);
  for (const std::size_t phase : {1U, 2U, 3U}) EXPECT_EQ(out->section_count[phase], 0U);
}

TEST(PhaseViewRules, AGapJoinsNothing) {
  PhaseViewConfig config = kRanges;
  config.known_period_s = 0.4;
  const auto view = std::make_unique<PhaseView>(config);
  view->update(on_circle(29, 0.4));
  view->update(on_circle(31, 0.4));  // a flash at 30, in the gap
  EXPECT_EQ(snapshot_of(*view)->section_count[1], 0U);
  view->update(on_circle(59, 0.4));
  view->update(on_circle(60, 0.4));
  EXPECT_EQ(snapshot_of(*view)->section_count[2], 1U);
}

}  // namespace
}  // namespace dampline

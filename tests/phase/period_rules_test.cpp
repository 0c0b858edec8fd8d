// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "dampline/phase/view.hpp"

namespace dampline {
namespace {

constexpr int kRuleLags = 400;
constexpr double kLagS = 0.02;
constexpr std::uint64_t kManyPairs = 1'000'000;

using Correlation400 = std::vector<double>;
Correlation400 correlation_of(const std::function<double(double)>& r) {
  Correlation400 out;
  for (int l = 0; l < kRuleLags; ++l) out.push_back(l == 0 ? 1.0 : r(l));
  return out;
}

double turn(double lags, double period) { return std::cos(2.0 * std::numbers::pi * lags / period); }

Period found_in(const Correlation400& r, std::uint64_t pairs = kManyPairs) {
  return find_period(r.data(), kRuleLags, pairs, kLagS);
}

double variance_of(const Correlation400& r, std::uint64_t pairs) {
  double sum = 1.0;
  for (std::size_t l = 1; l < r.size(); ++l) sum += 2.0 * r[l] * r[l];
  return sum / static_cast<double>(pairs);
}

TEST(FindPeriod, IsThePlaceOfThePeaksWithTheirHeight) {
  for (const double period : {8.0, 25.0, 37.4, 90.0}) {
    const auto r = correlation_of([&](double l) { return 0.7 * turn(l, period); });
    const Period out = found_in(r);
    ASSERT_EQ(out.state, PeriodState::kFound) << period;
    EXPECT_NEAR(out.period_s, period * kLagS, 1e-4 * period * kLagS);
    EXPECT_NEAR(out.height, 0.7, 0.02);
    EXPECT_NEAR(out.persistence, 1.0, 0.01);
    EXPECT_NEAR(out.confidence, out.persistence, 1e-9);
    EXPECT_LT(out.period_std_s, 1e-3 * out.period_s);
  }
}

// Parabolas around 30.3, 60.6, ...: the refined places are exact, also midway between two lags.
TEST(FindPeriod, RefinesPeaksByAParabola) {
  for (const double period : {30.3, 30.5}) {
    const auto r = correlation_of([period](double l) {
      const double off = std::remainder(l, period);
      return 0.6 - 0.02 * off * off;
    });
    const Period out = found_in(r);
    ASSERT_EQ(out.state, PeriodState::kFound);
    EXPECT_NEAR(out.period_s, period * kLagS, 1e-9);
    EXPECT_NEAR(out.height, 0.6, 1e-9);
    EXPECT_NEAR(out.period_std_s, 0.0, 1e-7);
  }
}

// Peaks off their places by +-d in turns: the slope's deviation, of which half are independent.
TEST(FindPeriod, StatesTheDeviationThatThePeaksPlacesScatterBy) {
  const auto place = [](int m) { return 30.0 * m + (m % 2 == 0 ? 1.0 : -1.0); };
  const auto r = correlation_of([&](double l) {
    const int m = static_cast<int>(std::lround(l / 30.0));
    const double off = l - place(m);
    return m == 0 ? -0.1 : 0.6 - 0.004 * off * off;
  });
  double sum_mm = 0.0, sum_mp = 0.0, sum_pp = 0.0;
  constexpr int kMultiples = 13;
  for (int m = 1; m <= kMultiples; ++m) {
    sum_mm += m * m;
    sum_mp += m * place(m);
    sum_pp += place(m) * place(m);
  }
  const double period = sum_mp / sum_mm;
  const double left = (sum_pp - sum_mp * period) / (kMultiples - 1);
  const Period out = found_in(r);
  ASSERT_EQ(out.state, PeriodState::kFound);
  EXPECT_NEAR(out.period_s, period * kLagS, 1e-9);
  EXPECT_NEAR(out.period_std_s, kLagS * std::sqrt(left / sum_mm * 0.5 * kMultiples), 1e-9);
}

TEST(FindPeriod, NeedsATenthOfTheVariance) {
  for (const auto& [height, state] :
       {std::pair{0.11, PeriodState::kFound}, std::pair{0.095, PeriodState::kNone}})
    EXPECT_EQ(found_in(correlation_of([h = height](double l) { return h * turn(l, 25.0); })).state,
              state);
}

TEST(FindPeriod, NeedsThreeDeviationsOfASignalWithoutMemory) {
  const auto r = correlation_of([](double l) { return 0.3 * turn(l, 25.0); });
  for (const auto& [z, state] :
       {std::pair{3.05, PeriodState::kFound}, std::pair{2.95, PeriodState::kNone}}) {
    const auto pairs = static_cast<std::uint64_t>(z * z * variance_of(r, 1) / 0.09);
    const Period out = found_in(r, pairs);
    EXPECT_EQ(out.state, state) << z;
    EXPECT_NEAR(out.confidence, 1.0 - std::exp(-0.5 * z * z), 1e-3);
    EXPECT_EQ(out.period_s > 0.0, state == PeriodState::kFound);
  }
}

// What noise keeps alive falls with the lag: the far half has 0.8 of the near one at least.
TEST(FindPeriod, APeriodPersists) {
  for (const auto& [memory, state] :
       {std::pair{1100.0, PeriodState::kFound}, std::pair{700.0, PeriodState::kNone}}) {
    const auto r =
        correlation_of([m = memory](double l) { return 0.8 * std::exp(-l / m) * turn(l, 25.0); });
    const Period out = found_in(r);
    EXPECT_EQ(out.state, state) << memory;
    double near = 0.0, far = 0.0;
    for (int k = 1; k <= 15; ++k) (k <= 7 ? near : far) += std::exp(-25.0 * k / memory);
    EXPECT_NEAR(out.persistence, (far / 8.0) / (near / 7.0), 2e-3);
  }
}

TEST(FindPeriod, TakesTheFirstPeakThatIsAlmostAsHighAsTheHighest) {
  for (const auto& [between, period] : {std::pair{0.88, 20.0}, std::pair{0.82, 40.0}}) {
    const auto r = correlation_of([b = between](double l) {
      const double fundamental = 0.5 * (1.0 - b);
      return fundamental * turn(l, 40.0) + (1.0 - fundamental) * turn(l, 20.0);
    });
    EXPECT_NEAR(found_in(r).period_s, period * kLagS, 0.2 * kLagS) << between;
  }
}

TEST(FindPeriod, LooksBetweenFourLagsAndAQuarterOfTheLongest) {
  for (const auto& [period, state] :
       {std::pair{3.2, PeriodState::kNone}, std::pair{5.0, PeriodState::kFound},
        std::pair{98.0, PeriodState::kFound}, std::pair{103.0, PeriodState::kNone}})
    EXPECT_EQ(found_in(correlation_of([p = period](double l) { return turn(l, p); })).state ==
                      PeriodState::kFound &&
                  std::abs(found_in(correlation_of([p = period](double l) {
                             return turn(l, p);
                           })).period_s -
                           period * kLagS) < 0.01 * period * kLagS,
              state == PeriodState::kFound)
        << period;
}

TEST(FindPeriod, FindsNoneWithoutAPeak) {
  for (const auto& r : {correlation_of([](double l) { return std::exp(-l / 50.0); }),
                        correlation_of([](double) { return -0.1; })}) {
    const Period out = found_in(r);
    EXPECT_EQ(out.state, PeriodState::kNone);
    for (const double figure : {out.period_s, out.height, out.persistence, out.confidence})
      EXPECT_EQ(figure, 0.0);
  }
}

TEST(FindPeriod, PersistsWhollyAtMost) {
  const auto r = correlation_of([](double l) { return 0.5 * (1.0 + l / 800.0) * turn(l, 25.0); });
  const Period out = found_in(r);
  EXPECT_EQ(out.state, PeriodState::kFound);
  EXPECT_EQ(out.persistence, 1.0);
  EXPECT_LE(out.confidence, 1.0);
}

TEST(ConfirmPeriod, LooksThreePercentAround) {
  const auto r = correlation_of([](double l) { return 0.8 * turn(l, 80.0); });
  const auto confirmed = [&](double lags) {
    return confirm_period(r.data(), kRuleLags, kManyPairs, kLagS, lags * kLagS);
  };
  for (const double lags : {77.8, 80.0, 82.4}) {
    EXPECT_EQ(confirmed(lags).state, PeriodState::kFound) << lags;
    EXPECT_NEAR(confirmed(lags).period_s, 80.0 * kLagS, 1e-3);
  }
  for (const double lags : {77.0, 83.0, 40.0})
    EXPECT_EQ(confirmed(lags).state, PeriodState::kNone) << lags;
  const auto brief = correlation_of([](double l) { return 0.8 * turn(l, 10.0); });
  const auto of_brief = [&](double lags) {
    return confirm_period(brief.data(), kRuleLags, kManyPairs, kLagS, lags * kLagS).state;
  };
  EXPECT_EQ(of_brief(10.9), PeriodState::kFound) << "one lag at least";
  EXPECT_EQ(of_brief(11.1), PeriodState::kNone);
}

TEST(ConfirmPeriod, NeedsFourOfItAndFourLags) {
  const auto r = correlation_of([](double l) { return 0.8 * turn(l, 5.0); });
  const auto state = [&](double lags) {
    return confirm_period(r.data(), kRuleLags, kManyPairs, kLagS, lags * kLagS).state;
  };
  EXPECT_NE(state(4.001), PeriodState::kNotEnough);
  EXPECT_EQ(state(3.999), PeriodState::kNotEnough);
  EXPECT_NE(state(99.49), PeriodState::kNotEnough);
  EXPECT_EQ(state(99.51), PeriodState::kNotEnough);
  EXPECT_EQ(state(std::nan("")), PeriodState::kNotEnough);
  EXPECT_NE(confirm_period(r.data(), kRuleLags, kManyPairs, 0.5, 49.75).state,
            PeriodState::kNotEnough)
      << "four of 99.5 lags are those that there are";
  EXPECT_NE(confirm_period(r.data(), kRuleLags, kManyPairs, 0.5, 2.0).state,
            PeriodState::kNotEnough)
      << "four lags";
}

TEST(PeriodMeter, KnowsEnoughFromThreeTimesItsLags) {
  using Small = PeriodMeter<64>;
  Small meter = Small::make(0.01, 2).value();
  constexpr int kNeeded = 2 * (63 + 3 * 64);
  for (int i = 1; i <= kNeeded; ++i) {
    meter.update(100.0 + std::sin(0.3 * i));
    EXPECT_EQ(meter.period().state == PeriodState::kNotEnough, i < kNeeded) << i;
    EXPECT_EQ(meter.confirm(0.2).state == PeriodState::kNotEnough, i < kNeeded) << i;
  }
  EXPECT_FALSE(Small::make(std::numeric_limits<double>::infinity(), 1).ok());
  EXPECT_TRUE(Small::make(0.01, 1).ok());
}

TEST(PeriodMeter, AfterARestartNeighboursAreNew) {
  using Small = PeriodMeter<64>;
  Small meter{0.01, 1};
  for (int part = 0; part < 300; ++part) {
    for (int i = 0; i < 63; ++i) meter.update(std::sin(0.3 * i));  // one too few for a pair
    meter.restart();
  }
  EXPECT_EQ(meter.period().state, PeriodState::kNotEnough);
}

// Of a lag that a gap cuts off nothing is left in the next one: what is constant stays so.
TEST(PeriodMeter, SumsNoLagAcrossAGap) {
  using Small = PeriodMeter<64>;
  for (const double constant : {0.0, 1.0}) {
    Small meter{0.01, 3};
    for (int part = 0; part < 20; ++part) {
      for (int i = 0; i < 600; ++i) meter.update(constant);
      meter.update(constant + part);
      meter.restart();
    }
    EXPECT_EQ(meter.period().state, PeriodState::kNoMotion) << constant;
  }
}

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

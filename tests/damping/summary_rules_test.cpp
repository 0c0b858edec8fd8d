// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "dampline/damping/estimator.hpp"
#include "dampline/damping/summary.hpp"
#include "dampline/estimate/velocity_error.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline {
namespace {

/// What saw so many seconds of a laden car.
std::unique_ptr<Estimator> after_ride(int seconds, std::uint64_t seed) {
  auto out = std::make_unique<Estimator>(EstimatorConfig{});
  sim::Simulation simulation{sim::reference_run(sim::Load::kLaden, 80.0, seed)};
  for (int i = 0; i < seconds * sim::kSampleRateHz; ++i)
    out->update(sim::to_sample(simulation.next()));
  out->finish();
  return out;
}

/// Of two minutes of a laden car, made once.
const Statistics& of_a_ride() {
  static const std::unique_ptr<Statistics> kOwner = [] {
    auto out = std::make_unique<Statistics>();
    after_ride(120, 5)->export_statistics(*out);
    return out;
  }();
  return *kOwner;
}

/// The same where so much of the motion was slower than 2 mm/s.
Snapshot with_share(double share, double mass_kg = 1000.0) {
  const auto statistics = std::make_unique<Statistics>(of_a_ride());
  VelocityCounts& velocity = statistics->header.velocity;
  velocity.moving = 1'000'000;
  velocity.sticking = static_cast<std::uint64_t>(std::llround(1e6 * share));
  velocity.sum_squares = 1e6 * 0.02 * 0.02;
  return summarise(*statistics, {.moving_mass_kg = mass_kg});
}

/// By what the variance grew, as a share of the value.
double grown(const Estimate& to, const Estimate& from) {
  return std::sqrt(std::max(to.std * to.std - from.std * from.std, 0.0)) / to.value;
}

/// Information of all windows but those of one length.
std::unique_ptr<Statistics> without_scale(std::size_t scale) {
  auto out = std::make_unique<Statistics>(of_a_ride());
  const auto leave = [&](ScaleFactors& f) {
    f.factor[scale].clear();
    f.rows[scale] = 0.0;
  };
  leave(out->total);
  for (ScaleFactors& f : out->entries) leave(f);
  return out;
}

// The stiffness is that of the four longest lengths.
TEST(SummaryRules, NothingIsValidWithoutLongWindows) {
  auto only_short = std::make_unique<Statistics>(of_a_ride());
  for (std::size_t s = 0; s + 1 < kScales; ++s) {
    EXPECT_TRUE(summarise(*without_scale(s), {.moving_mass_kg = 1000.0}).valid) << s;
    only_short->total.factor[s].clear();
  }
  const Snapshot none = summarise(*only_short, {.moving_mass_kg = 1000.0});
  EXPECT_FALSE(none.valid);
  EXPECT_EQ(none.coulomb_n.value, 0.0);
}

// Of eight rides of a minute.
TEST(SummaryRules, TheWidthsDeviationIsThatOfItsScatter) {
  double sum = 0.0, squares = 0.0, stated = 0.0;
  constexpr int kRides = 8;
  for (int ride = 0; ride < kRides; ++ride) {
    const Estimate width =
        after_ride(60, 100 + static_cast<std::uint64_t>(ride))->snapshot().law_width_mps;
    sum += width.value;
    squares += width.value * width.value;
    stated += width.std / kRides;
  }
  const double mean = sum / kRides;
  const double scatter = std::sqrt((squares - kRides * mean * mean) / (kRides - 1));
  EXPECT_GT(stated / scatter, 0.4) << stated << " " << scatter;
  EXPECT_LT(stated / scatter, 2.5) << stated << " " << scatter;
}

TEST(SummaryRules, EveryForceIsThatOfTheMass) {
  const Snapshot one = with_share(0.05);
  const Snapshot ten = with_share(0.05, 10'000.0);
  ASSERT_TRUE(one.valid);
  EXPECT_NEAR(ten.coulomb_n.value / one.coulomb_n.value, 10.0, 1e-12);
  EXPECT_NEAR(ten.stiffness_npm.std / one.stiffness_npm.std, 10.0, 1e-12);
  EXPECT_NEAR(ten.viscous_nspm.std / one.viscous_nspm.std, 10.0, 1e-12);
  EXPECT_NEAR(ten.curve[3].force_n / one.curve[3].force_n, 10.0, 1e-12);
  EXPECT_NEAR(ten.curve_std_at_zero_n / one.curve_std_at_zero_n, 10.0, 1e-12);
  EXPECT_EQ(ten.law_width_mps.value, one.law_width_mps.value);
  EXPECT_NEAR(one.velocity_rms_mps, 0.02, 1e-12);
  EXPECT_NEAR(one.stick_share, 0.05, 1e-12);
}

// 5 % of the value for each unit of the share beyond 0.12; of the stiffness 32 % beyond 0.18.
TEST(SummaryRules, WhatStickingLeavesIsInTheDeviations) {
  const Snapshot none = with_share(0.0);
  EXPECT_EQ(with_share(0.12).coulomb_n.std, none.coulomb_n.std);
  EXPECT_NEAR(grown(with_share(0.15).coulomb_n, none.coulomb_n), 0.05 * 0.03, 1e-8);
  EXPECT_EQ(with_share(0.18).stiffness_npm.std, none.stiffness_npm.std);
  EXPECT_NEAR(grown(with_share(0.2).stiffness_npm, none.stiffness_npm), 0.32 * 0.02, 1e-8);
  EXPECT_NEAR(grown(with_share(0.5).stiffness_npm, none.stiffness_npm), 0.32 * 0.32, 1e-8);
  const double width_mps = none.law_width_with_viscous_mps.value;
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    const auto of = [&](const Snapshot& s) {
      return Estimate{s.curve[i].force_n, s.curve[i].std_n};
    };
    const double near = 1.0 + 2.0 * width_mps / none.curve[i].velocity_mps;
    EXPECT_NEAR(grown(of(with_share(0.32)), of(none)), near * 0.05 * 0.2, 1e-8) << i;
  }
}

TEST(SummaryRules, TheBentLawCountsFromAShareOf15PercentAndAloneFrom25) {
  const double level = with_share(0.15).coulomb_n.value;
  EXPECT_EQ(level, with_share(0.0).coulomb_n.value);
  const double bent = with_share(0.25).coulomb_n.value;
  EXPECT_NE(bent, level);
  EXPECT_EQ(with_share(0.6).coulomb_n.value, bent);
  EXPECT_NEAR(with_share(0.2).coulomb_n.value, 0.5 * (level + bent), 1e-9 * level);
  EXPECT_NEAR(with_share(0.175).coulomb_n.value, 0.75 * level + 0.25 * bent, 1e-9 * level);
}

TEST(SummaryRules, DeviationsAreLowerBoundsWhereTheTruckSticksForAQuarter) {
  EXPECT_FALSE(with_share(0.25).std_is_lower_bound);
  EXPECT_FALSE(with_share(0.25).std_with_viscous_is_lower_bound);
  EXPECT_TRUE(with_share(0.2501).std_is_lower_bound);
  EXPECT_TRUE(with_share(0.2501).std_with_viscous_is_lower_bound);
}

// What slow sampling loses is in both: of the level a share, of the stiffness a deviation.
TEST(SummaryRules, TheLevelAndTheStiffnessKnowTheRate) {
  const auto at_rate = [](double rate_hz) {
    const auto statistics = std::make_unique<Statistics>(of_a_ride());
    statistics->header.sample_rate_hz = rate_hz;
    return summarise(*statistics, {.moving_mass_kg = 1000.0});
  };
  const Snapshot unknown = at_rate(0.0);
  for (const double rate_hz : {150.0, 200.0, 400.0}) {
    const Snapshot known = at_rate(rate_hz);
    const VelocityError error{rate_hz, known.velocity_rms_mps};
    const double width_mps = known.law_width_mps.value;
    const Estimate level = error.coulomb(unknown.coulomb_n, width_mps);
    const Estimate stiffness = error.stiffness(unknown.stiffness_npm, width_mps);
    EXPECT_NEAR(known.coulomb_n.value / level.value, 1.0, 1e-12) << rate_hz;
    EXPECT_NEAR(known.coulomb_n.std / level.std, 1.0, 1e-12) << rate_hz;
    EXPECT_NEAR(known.stiffness_npm.value / stiffness.value, 1.0, 1e-12) << rate_hz;
    EXPECT_NEAR(known.stiffness_npm.std / stiffness.std, 1.0, 1e-12) << rate_hz;
  }
  EXPECT_GT(at_rate(150.0).stiffness_npm.std, 1.1 * unknown.stiffness_npm.std);
}

// 0.1, 0.3 and 0.25 %: errors that the scatter of the blocks does not show.
TEST(SummaryRules, NoDeviationIsBelowItsFloor) {
  const Snapshot s = with_share(0.0);
  EXPECT_GT(s.coulomb_n.std, 0.0010 * s.coulomb_n.value);
  EXPECT_GT(s.stiffness_npm.std, 0.0030 * s.stiffness_npm.value);
  EXPECT_GT(s.viscous_nspm.std, 0.0030 * s.coulomb_with_viscous_n.value / 0.02);
  EXPECT_GT(s.curve_std_at_zero_n, 0.0010 * s.curve_force_at_zero_n);
  for (const auto& point : s.curve) {
    const double near = s.law_width_with_viscous_mps.value / point.velocity_mps;
    EXPECT_GT(point.std_n, std::hypot(0.0025, 0.03 * near) * point.force_n);
  }
}

TEST(SummaryRules, ADeviationOfTheViscousPartGrowsAsTheMotionFalls) {
  const auto at = [](double rms_mps) {
    const auto statistics = std::make_unique<Statistics>(of_a_ride());
    VelocityCounts& velocity = statistics->header.velocity;
    velocity.moving = 1000;
    velocity.sticking = 0;
    velocity.sum_squares = 1000.0 * rms_mps * rms_mps;
    return summarise(*statistics, {.moving_mass_kg = 1.0});
  };
  const Snapshot fast = at(1e6);
  const Snapshot slow = at(0.01);
  const double floor = 0.003 * slow.coulomb_with_viscous_n.value / 0.01;
  EXPECT_NEAR(slow.viscous_nspm.std, std::hypot(fast.viscous_nspm.std, floor), 1e-9);
  const auto unknown = std::make_unique<Statistics>(of_a_ride());
  unknown->header.velocity = {};
  const Snapshot none = summarise(*unknown, {.moving_mass_kg = 1.0});
  EXPECT_NEAR(none.viscous_nspm.std, fast.viscous_nspm.std, 1e-9) << "of no motion there is none";
  EXPECT_EQ(none.stick_share, 0.0);
  EXPECT_EQ(none.velocity_rms_mps, 0.0);
}

TEST(SummaryRules, NeedsFourEntriesAndFiveForHeldOutErrors) {
  const auto with_entries = [](std::uint32_t count) {
    const auto statistics = std::make_unique<Statistics>(of_a_ride());
    EXPECT_GE(statistics->header.entry_count, 6U);
    statistics->header.entry_count = count;
    return summarise(*statistics, {.moving_mass_kg = 1.0});
  };
  EXPECT_FALSE(with_entries(3).valid);
  EXPECT_TRUE(with_entries(4).valid);
  EXPECT_TRUE(std::isnan(with_entries(4).held_out_nmse));
  EXPECT_TRUE(std::isfinite(with_entries(5).held_out_nmse));
  EXPECT_TRUE(std::isfinite(with_entries(5).held_out_nmse_with_viscous));
}

TEST(SummaryRules, ALevelAloneNeedsFourEntriesToo) {
  const auto statistics = std::make_unique<Statistics>(of_a_ride());
  for (const std::uint32_t count : {0U, 3U, 4U, 5U}) {
    statistics->header.entry_count = count;
    EXPECT_EQ(summarise_level(*statistics, {.moving_mass_kg = 1.0}).valid, count >= 4) << count;
  }
}

TEST(SummaryRules, HandsOnWhatTheStatisticsSay) {
  const auto statistics = std::make_unique<Statistics>(of_a_ride());
  StatisticsHeader& header = statistics->header;
  header.noise_mps2 = 0.031;
  header.newest_tick = 123'456;
  header.counts.samples = 77;
  header.counts.gaps = 3;
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    header.velocity.positive[i] = 100 + i;
    header.velocity.negative[i] = 200 + i;
  }
  const Snapshot s = summarise(*statistics, {.moving_mass_kg = 1000.0});
  EXPECT_EQ(s.noise_mps2, 0.031);
  EXPECT_EQ(s.tick, 123'456);
  EXPECT_EQ(s.counts.samples, 77U);
  EXPECT_EQ(s.counts.gaps, 3U);
  EXPECT_EQ(s.blocks_in_estimate, statistics->total.blocks);
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    EXPECT_EQ(s.curve[i].velocity_mps, header.curve_nodes_mps[i]);
    EXPECT_EQ(s.curve[i].samples, 100 + i);
    EXPECT_EQ(s.samples_negative[i], 200 + i);
  }
}

TEST(SummaryRules, ExcitationIsTheShareOfBlocksThatMoved) {
  const auto statistics = std::make_unique<Statistics>(of_a_ride());
  statistics->header.counts.blocks = 10;
  statistics->header.counts.blocks_still = 3;
  EXPECT_NEAR(summarise(*statistics, {}).excitation, 0.7, 1e-12);
  statistics->header.counts.blocks = 0;
  EXPECT_EQ(summarise(*statistics, {}).excitation, Snapshot{}.excitation);
}

TEST(SummaryRules, ALevelAloneHasTheSameBits) {
  const Snapshot all = summarise(of_a_ride(), {.moving_mass_kg = 37200.0});
  const Level level = summarise_level(of_a_ride(), {.moving_mass_kg = 37200.0});
  ASSERT_TRUE(level.valid);
  EXPECT_EQ(level.coulomb_n.value, all.coulomb_n.value);
  EXPECT_EQ(level.coulomb_n.std, all.coulomb_n.std);
  EXPECT_EQ(level.stiffness_npm.value, all.stiffness_npm.value);
  EXPECT_EQ(level.stiffness_npm.std, all.stiffness_npm.std);
}

}  // namespace
}  // namespace dampline

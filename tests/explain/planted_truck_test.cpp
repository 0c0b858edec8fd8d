// SPDX-License-Identifier: MIT
// Effects of sizes between the grids, planted by the other simulation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "app/diagnosis/truck/explain.hpp"
#include "app/diagnosis/truck/explanation.hpp"
#include "tests/drivers/temporary_file.hpp"
#include "tests/explain/other_truck.hpp"

namespace dampline::app {
namespace {

using dampline::test::backlash;
using dampline::test::force;
using dampline::test::kCoulombN;
using dampline::test::kFine;
using dampline::test::kSpringNpm;
using dampline::test::kStepS;
using dampline::test::level;
using dampline::test::mode;
using dampline::test::Plant;
using dampline::test::presliding;
using dampline::test::sign;
using dampline::test::State;
using dampline::test::viscoelastic;

Explained explained(const Plant& plant, std::uint64_t seed) {
  const dampline::test::TemporaryFile file{dampline::test::record_of(plant, seed), ".csv"};
  Config config;
  config.car.moving_mass_kg = plant.moving_mass_kg;
  return explain_truck(config, {{file.path(), false}, {}, false});
}

struct Planted {
  const char* name;
  const char* effect;
  Plant plant;
};

class NamesOnATruck : public ::testing::TestWithParam<Planted> {};

TEST_P(NamesOnATruck, WhatWasPlanted) {
  const Explained found = explained(GetParam().plant, 17);
  const effect::Explanation& e = found.explanation;
  ASSERT_GE(e.step_count, 1U) << summarize(found);
  EXPECT_STREQ(effect::name_of(e.step[0].chosen.effect), GetParam().effect) << summarize(found);
  EXPECT_LT(e.final.held_out_nmse, e.base.held_out_nmse);
  EXPECT_NEAR(e.final_stiffness_npm.value, kSpringNpm, 0.1 * kSpringNpm) << summarize(found);
}

Plant late() {
  Plant out;
  out.frame_late = 7 * kFine / 16;  // 1.46 ms
  return out;
}
Plant wrong_gain() {
  Plant out;
  out.gain[2] = 0.957;
  return out;
}

INSTANTIATE_TEST_SUITE_P(
    Laws, NamesOnATruck,
    ::testing::Values(
        Planted{"viscous", "viscous", force([](const State& s) { return 97e3 * s.velocity_mps; })},
        Planted{"asymmetric_viscous", "asymmetric_viscous", force([](const State& s) {
                  return (s.velocity_mps > 0.0 ? 190e3 : 30e3) * s.velocity_mps;
                })},
        Planted{"quadratic_damping", "quadratic_damping", force([](const State& s) {
                  return 5.1e6 * s.velocity_mps * std::abs(s.velocity_mps);
                })},
        Planted{"viscoelastic", "viscoelastic", viscoelastic(2.7e6, 0.034)},
        Planted{"soft_rubber", "viscoelastic", viscoelastic(1.1e6, 0.017)},
        Planted{"stribeck", "stribeck", level([](const State& s) {
                  const double u = s.velocity_mps / 0.012;
                  return kCoulombN * (1.0 + 0.45 * std::exp(-u * u));
                })},
        Planted{"progressive_friction", "progressive_friction", level([](const State& s) {
                  return kCoulombN * std::max(1.0 + s.deflection_m / 0.0047, 0.0);
                })},
        Planted{"presliding_hysteresis", "presliding_hysteresis", presliding(1.3e-4)},
        Planted{"backlash", "backlash", backlash(3.3e-4)},
        Planted{"bump_stop", "bump_stop", force([](const State& s) {
                  const double over = std::max(std::abs(s.deflection_m) - 0.00137, 0.0);
                  return 14e6 * over * sign(s.deflection_m);
                })},
        Planted{"one_sided_stop", "bump_stop", force([](const State& s) {
                  return 17e6 * std::min(s.deflection_m + 0.00119, 0.0);
                })},
        Planted{"cubic_stiffness", "cubic_stiffness",
                force([](const State& s) { return 4.4e11 * std::pow(s.deflection_m, 3); })},
        Planted{"quadratic_stiffness", "quadratic_stiffness",
                force([](const State& s) { return 6e8 * s.deflection_m * s.deflection_m; })},
        Planted{"asymmetric_stiffness", "asymmetric_stiffness",
                force([](const State& s) { return 0.7e6 * std::abs(s.deflection_m); })},
        Planted{"mode", "unmodelled_mode", mode(0.21, 10.7)},
        Planted{"mode_beyond_the_grid", "unmodelled_mode", mode(0.21, 19.3)},
        Planted{"time_skew", "time_skew", late()},
        Planted{"gain_error", "gain_error", wrong_gain()}),
    [](const ::testing::TestParamInfo<Planted>& tested) { return std::string{tested.param.name}; });

double found_in(const effect::Step& step, const std::string& name) {
  for (std::size_t i = 0; i < step.parameter_count; ++i)
    if (name == step.parameter[i].name) return step.parameter[i].estimate.value;
  return 0.0;
}

TEST(ATruck, ALateChannelIsSetRight) {
  Plant plant;
  plant.frame_late = 11 * kFine / 16;
  const Explained found = explained(plant, 18);
  const effect::Explanation& e = found.explanation;
  ASSERT_EQ(e.step_count, 1U) << summarize(found);
  // The motion, which takes the new velocity for its step, is half a step ahead of the input.
  const double late_s = (static_cast<double>(plant.frame_late) - 0.5) * kStepS;
  EXPECT_NEAR(found_in(e.step[0], "time_skew_frame"), late_s, 0.03 * late_s) << summarize(found);
  EXPECT_NEAR(e.final_coulomb_n.value, kCoulombN, 0.01 * kCoulombN);
  EXPECT_NEAR(e.final_stiffness_npm.value, kSpringNpm, 0.02 * kSpringNpm) << summarize(found);
}

TEST(ATruck, AModeIsFoundBetweenThePointsOfItsGrid) {
  const Explained found = explained(mode(0.21, 9.65), 19);
  const effect::Explanation& e = found.explanation;
  ASSERT_EQ(e.step_count, 1U) << summarize(found);
  EXPECT_NEAR(found_in(e.step[0], "unmodelled_mode_frequency"), 9.65, 0.05) << summarize(found);
}

TEST(ATruck, LacksNothingWhereNothingIsMissing) {
  for (const std::uint64_t seed : {21U, 22U}) {
    const Explained found = explained(Plant{}, seed);
    EXPECT_EQ(found.explanation.conclusion, effect::Conclusion::kComplete) << summarize(found);
    EXPECT_NEAR(found.explanation.base_coulomb_n.value, kCoulombN, 0.02 * kCoulombN);
  }
}

TEST(ATruck, LacksSomethingWithoutAName) {
  // A force that has nothing to do with the motion.
  const Explained found = explained(force([](const State& s) {
                                      return 5e3 * std::sin(31.0 * s.time_s) *
                                             std::sin(0.37 * s.time_s * std::sqrt(s.time_s + 1.0));
                                    }),
                                    31);
  EXPECT_EQ(found.explanation.step_count, 0U) << summarize(found);
  EXPECT_EQ(found.explanation.conclusion, effect::Conclusion::kUnexplained) << summarize(found);
}

/// By the other simulation; the other truck's friction is not this one's.
TEST(ATruckNightly, SeesTheOtherTruckOfTheBodyInItsOwnMotion) {
  for (const test::Coupling& to :
       {test::Coupling{5600.0, 0.43, 1.0}, {5600.0, -0.43, 1.15}, {4400.0, 0.31, 0.9}}) {
    const Explained found = explained(test::coupled(to), 27);
    const Explanation all = told(found);
    ASSERT_TRUE(found.other) << summarize(all);
    EXPECT_EQ(all.steps.front().effect, "other_truck") << summarize(all);
    EXPECT_EQ(all.verdict, "explained") << summarize(all);
    EXPECT_NEAR(found.other->delay_s.value, to.delay_s, 1e-3);
    EXPECT_NEAR(found.other->mass_kg.value, to.mass_kg, 3.0 * found.other->mass_kg.std);
    EXPECT_NEAR(found.explanation.final_coulomb_n.value, kCoulombN, 0.03 * kCoulombN);
    EXPECT_NEAR(found.explanation.final_stiffness_npm.value, kSpringNpm, 0.05 * kSpringNpm);
  }
}

Plant changing_at(double time_s, Plant before, Plant after) {
  Plant out = level([=](const State& s) { return (s.time_s < time_s ? before : after).level(s); });
  out.force = [=](const State& s) mutable { return (s.time_s < time_s ? before : after).force(s); };
  return out;
}

TEST(ATruck, WhoseGapBeginsIsNotSimplyCalledLate) {
  const Explained found = explained(changing_at(60.0, {}, backlash(4e-4)), 31);
  const Explanation all = told(found);
  EXPECT_TRUE(all.alike.find("backlash") != std::string::npos || all.steps.empty() ||
              all.steps.front().effect == "backlash")
      << summarize(all);
  EXPECT_NE(all.trust, Trust::kTrusted) << summarize(all);
}

TEST(ATruck, WhoseGapGrowsHasNoOtherMass) {
  const Explained found = explained(changing_at(60.0, backlash(3e-4), backlash(7e-4)), 32);
  RunResult result = found.identified;
  const Explanation all = conclude(found, result);
  ASSERT_FALSE(all.steps.empty()) << summarize(all);
  EXPECT_EQ(all.steps.front().effect, "backlash") << summarize(all);
  ASSERT_TRUE(result.faults.drift) << summarize(all);
  EXPECT_EQ(result.faults.drift->parameter, DriftFinding::kNotTold) << summarize(all);
}

}  // namespace
}  // namespace dampline::app

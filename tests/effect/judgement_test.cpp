// SPDX-License-Identifier: MIT
#include "dampline/effect/judgement.hpp"

#include <gtest/gtest.h>

#include <array>
#include <tuple>
#include <utility>

namespace dampline::effect {
namespace {

FaultView with(FaultKind kind, FaultChannel channel) {
  FaultView view;
  view.faults[view.count++] = {.kind = kind, .channel = channel, .time_s = 12.0};
  return view;
}

constexpr std::array kPassing{FaultKind::kSpikes, FaultKind::kDcJump, FaultKind::kNoiseBurst};

Explanation explained_by_one_effect(double gain) {
  Explanation explanation;
  explanation.conclusion = Conclusion::kExplained;
  explanation.base.held_out_nmse = 0.2;
  explanation.final.held_out_nmse = 0.2 * (1.0 - gain);
  explanation.step_count = 1;
  explanation.step[0].gain = gain;
  return explanation;
}

TEST(Judgement, IsForFaultsThatLookLikeEffects) {
  EXPECT_TRUE(forbids_naming(with(FaultKind::kClockDrift, FaultChannel::kFrame)));
  EXPECT_TRUE(forbids_naming(with(FaultKind::kLostSamples, FaultChannel::kWheelset1)));
  EXPECT_FALSE(forbids_naming(with(FaultKind::kLostSamples, FaultChannel::kAll)));
  EXPECT_FALSE(forbids_naming(with(FaultKind::kStuckChannel, FaultChannel::kFrame)));
  EXPECT_FALSE(forbids_naming({}));
}

TEST(Judgement, AnImpossibleLawExplainsNothing) {
  Explanation e = explained_by_one_effect(0.5);
  e.final_coulomb_n = {8000.0, 40.0};
  e.final_stiffness_npm = {5e6, 2e4};
  conclude(0, e);
  EXPECT_EQ(e.conclusion, Conclusion::kExplained);
  e.final_stiffness_npm.value = -4e5;
  conclude(0, e);
  EXPECT_EQ(e.conclusion, Conclusion::kPartlyExplained);
  e.step_count = 0;
  e.final_stiffness_npm.value = 5e6;
  e.final_coulomb_n.value = -3683.0;
  conclude(0, e);
  EXPECT_EQ(e.conclusion, Conclusion::kUnexplained);
  EXPECT_FALSE(is_possible(e));
}

// As a frame behind 30 Hz beside wheelsets behind 100 had: "backlash" of 2.7 +- 1.8 times its
// level.
TEST(Conclusion, NoFrictionThatMayBeNothingBuildsUp) {
  Explanation e = explained_by_one_effect(0.5);
  e.final_coulomb_n = {13'000.0, 15'000.0};
  e.final_stiffness_npm = {5e6, 2e4};
  for (const auto& [effect, possible] :
       {std::pair{Effect::kBacklash, false}, std::pair{Effect::kPreslidingHysteresis, false},
        std::pair{Effect::kViscous, true}, std::pair{Effect::kViscoelastic, true}}) {
    e.step[0].chosen.effect = effect;
    EXPECT_EQ(is_possible(e), possible) << name_of(effect);
  }
  e.final_coulomb_n.std = 6'000.0;
  e.step[0].chosen.effect = Effect::kBacklash;
  EXPECT_TRUE(is_possible(e));
}

TEST(Conclusion, AModelIsPossibleWithFrictionAndASpringAboveNothing) {
  Explanation e;
  for (const auto& [coulomb, stiffness, possible] :
       {std::tuple{1.0, 1.0, true}, std::tuple{0.0, 1.0, false}, std::tuple{1.0, 0.0, false},
        std::tuple{-1.0, 1.0, false}, std::tuple{1.0, -1.0, false}}) {
    e.final_coulomb_n.value = coulomb;
    e.final_stiffness_npm.value = stiffness;
    EXPECT_EQ(is_possible(e), possible) << coulomb << ' ' << stiffness;
  }
}

TEST(Conclusion, ADamperThatSurelyDrivesIsImpossible) {
  Explanation e;
  e.final_coulomb_n.value = e.final_stiffness_npm.value = 1.0;
  e.step_count = 1;
  Step& step = e.step[0];
  step.parameter_count = 2;
  step.parameter[0] = {"viscous_positive", {5.0, 1.0}, "N s/m"};
  for (const auto& [effect, damps] :
       {std::pair{Effect::kViscous, true}, std::pair{Effect::kAsymmetricViscous, true},
        std::pair{Effect::kQuadraticDamping, true}, std::pair{Effect::kViscoelastic, true},
        std::pair{Effect::kGainError, false}, std::pair{Effect::kProgressiveFriction, false}}) {
    step.chosen.effect = effect;
    step.parameter[1] = {"viscous_negative", {-1.9, 1.0}, "N s/m"};
    EXPECT_TRUE(is_possible(e)) << name_of(effect);
    step.parameter[1].estimate.value = -2.1;
    EXPECT_EQ(is_possible(e), !damps) << name_of(effect);
  }
}

/// What is concluded of an error so many times the floor.
Conclusion concluded(double ratio, std::uint64_t impacts, bool step) {
  Explanation e = explained_by_one_effect(0.5);
  if (!step) e.step_count = 0;
  e.final_coulomb_n = {8000.0, 40.0};
  e.final_stiffness_npm = {5e6, 2e4};
  e.final.held_out_nmse = 0.01 * ratio;
  e.floor_nmse = ratio > 0.0 ? 0.01 : 0.0;
  conclude(impacts, e);
  return e.conclusion;
}

// A quarter more than the floor without an effect, half of it with one, or among ten impacts.
TEST(Conclusion, IsOfTheErrorOverItsFloor) {
  EXPECT_EQ(concluded(1.24, 0, false), Conclusion::kComplete);
  EXPECT_EQ(concluded(1.26, 0, false), Conclusion::kUnexplained);
  EXPECT_EQ(concluded(1.26, 9, false), Conclusion::kUnexplained);
  EXPECT_EQ(concluded(1.49, 10, false), Conclusion::kComplete);
  EXPECT_EQ(concluded(1.51, 10, false), Conclusion::kUnexplained);
  EXPECT_EQ(concluded(1.49, 0, true), Conclusion::kExplained);
  EXPECT_EQ(concluded(1.51, 0, true), Conclusion::kPartlyExplained);
  EXPECT_EQ(concluded(1.5, 0, true), Conclusion::kExplained) << "above it is partly";
  EXPECT_EQ(concluded(1.25, 0, false), Conclusion::kComplete);
  EXPECT_EQ(concluded(0.0, 0, false), Conclusion::kComplete) << "without a floor";
}

TEST(Conclusion, HasANameForEach) {
  EXPECT_STREQ(name_of(Conclusion::kNotReady), "not_ready");
  EXPECT_STREQ(name_of(Conclusion::kComplete), "complete");
  EXPECT_STREQ(name_of(Conclusion::kExplained), "explained");
  EXPECT_STREQ(name_of(Conclusion::kPartlyExplained), "partly_explained");
  EXPECT_STREQ(name_of(Conclusion::kUnexplained), "unexplained");
}

// Restated with the weights of the final model, where there is one.
TEST(Conclusion, ComparesWithTheBaseByTheSameWeights) {
  Explanation e = explained_by_one_effect(0.5);
  EXPECT_EQ(base_error(e), 0.2);
  e.base_restated_nmse = 0.3;
  EXPECT_EQ(base_error(e), 0.3);
  e.step_count = 0;
  EXPECT_EQ(base_error(e), 0.2);
}

TEST(Conclusion, WithoutStepsIsTheBase) {
  Explanation e = explained_by_one_effect(0.5);
  e.base_model.count = 1;
  e.model.count = 3;
  e.base_weight.fill(2.0);
  e.base_floor_nmse = 0.07;
  e.base_coulomb_n = {7000.0, 30.0};
  e.base_stiffness_npm = {4e6, 1e4};
  drop_steps(e);
  EXPECT_EQ(e.step_count, 0U);
  EXPECT_EQ(e.model.count, 1U);
  EXPECT_EQ(e.final.held_out_nmse, 0.2);
  EXPECT_EQ(e.weight[2], 2.0);
  EXPECT_EQ(e.floor_nmse, 0.07);
  EXPECT_EQ(e.final_coulomb_n.value, 7000.0);
  EXPECT_EQ(e.final_stiffness_npm.value, 4e6);
}

TEST(Judgement, LetsTheDiagnosisGoOnWhereAFaultThatPassesWasLeftOut) {
  for (const FaultKind kind : kPassing) {
    FaultView faults = with(kind, FaultChannel::kFrame);
    EXPECT_TRUE(forbids_naming(faults)) << name_of(kind);
    faults.repairs.spoilt = 600;
    EXPECT_FALSE(forbids_naming(faults)) << name_of(kind);
  }
  FaultView lasting = with(FaultKind::kClockDrift, FaultChannel::kFrame);
  lasting.repairs.replaced = 3;
  EXPECT_TRUE(forbids_naming(lasting));
}

TEST(Judgement, TakesNoFaultThatPassedForAnImpulsiveInput) {
  constexpr auto kImpulsive = static_cast<std::size_t>(Effect::kImpulsiveInput);
  for (const FaultKind kind : kPassing) {
    ExplainerConfig config;
    disallow_mimics(with(kind, FaultChannel::kFrame), config);
    EXPECT_FALSE(config.allowed[kImpulsive]) << name_of(kind);
    config.allowed[kImpulsive] = true;
    EXPECT_EQ(config.allowed, ExplainerConfig::all()) << name_of(kind);
  }
  ExplainerConfig config;
  disallow_mimics(with(FaultKind::kLostSamples, FaultChannel::kAll), config);
  EXPECT_EQ(config.allowed, ExplainerConfig::all());
}

TEST(Judgement, NamesNoModeWhereMuchWasPutIn) {
  for (const auto& [share, allowed] : {std::pair{0.04, true}, std::pair{0.06, false}}) {
    FaultView faults;
    faults.repairs.bridged.share = share;
    ExplainerConfig config;
    disallow_mimics(faults, config);
    EXPECT_EQ(config.allowed[static_cast<std::size_t>(Effect::kUnmodelledMode)], allowed) << share;
    EXPECT_FALSE(config.allowed[static_cast<std::size_t>(Effect::kImpulsiveInput)]) << share;
  }
}

TEST(Judgement, TakesBackWhatWasAdded) {
  Explanation explanation = explained_by_one_effect(0.5);
  withhold_effects(explanation);
  EXPECT_EQ(explanation.conclusion, Conclusion::kUnexplained);
  EXPECT_EQ(explanation.step_count, 0U);
  EXPECT_EQ(explanation.final.held_out_nmse, 0.2);
}

TEST(Judgement, PrefersAParameterThatChangedWhereItExplainsMore) {
  ParameterDrift drift;
  EXPECT_FALSE(drift_explains_more(drift, explained_by_one_effect(0.3)));
  drift.found = true;
  drift.gain = 0.4;
  EXPECT_TRUE(drift_explains_more(drift, explained_by_one_effect(0.3)));
  EXPECT_FALSE(drift_explains_more(drift, explained_by_one_effect(0.39)));
  EXPECT_TRUE(drift_explains_more(drift, explained_by_one_effect(0.379))) << "by two parts of 100";
  EXPECT_FALSE(drift_explains_more(drift, explained_by_one_effect(0.381)));
  Explanation nothing = explained_by_one_effect(0.9);
  nothing.step_count = 0;
  EXPECT_TRUE(drift_explains_more(drift, nothing)) << "where no effect explains anything";
}

}  // namespace
}  // namespace dampline::effect

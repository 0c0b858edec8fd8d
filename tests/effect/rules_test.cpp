// SPDX-License-Identifier: MIT
#include "dampline/effect/rules.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

namespace dampline::effect {
namespace {

Step step(Effect effect, double gain, double block_t, double coefficient_t) {
  Step out;
  out.chosen.effect = effect;
  out.gain = gain;
  out.block_t = block_t;
  out.coefficient_t = coefficient_t;
  return out;
}

Model with(Effect effect) {
  Candidate known;
  known.effect = effect;
  known.count = 1;
  return Model{}.with(known);
}

Verdict later(Effect known, const Step& s) { return judge_step(with(known), false, true, s); }

TEST(Rules, OnlyASpringThatBendsMayComeFirstWithHardlyAnyGain) {
  EXPECT_EQ(judge_step({}, true, true, step(Effect::kCubicStiffness, 5e-4, 3.0, 4.5)),
            Verdict::kYes);
  EXPECT_EQ(judge_step({}, true, true, step(Effect::kCubicStiffness, 5e-4, 3.0, 3.5)),
            Verdict::kNo);
  EXPECT_EQ(judge_step({}, true, true, step(Effect::kCubicStiffness, -1e-5, 3.0, 4.5)),
            Verdict::kNo);
  // Not where another leaves less, nor where the blocks do not agree.
  EXPECT_EQ(judge_step({}, true, false, step(Effect::kCubicStiffness, 5e-4, 3.0, 4.5)),
            Verdict::kNo);
  EXPECT_EQ(judge_step({}, true, true, step(Effect::kCubicStiffness, 5e-4, 2.1, 4.5)),
            Verdict::kNo);
  for (const Effect e : {Effect::kViscous, Effect::kBumpStop, Effect::kUnmodelledMode})
    EXPECT_EQ(judge_step({}, true, true, step(e, 5e-4, 1.0, 40.0)), Verdict::kNo);
}

TEST(Rules, TheSecondNeedsASureCoefficient) {
  EXPECT_EQ(later(Effect::kViscous, step(Effect::kGainError, 0.016, 6.0, 17.0)), Verdict::kYes);
  EXPECT_EQ(later(Effect::kViscous, step(Effect::kGainError, 0.016, 6.0, 9.0)), Verdict::kNo);
  EXPECT_EQ(later(Effect::kViscous, step(Effect::kGainError, 0.008, 6.0, 17.0)), Verdict::kNo);
  // Stops are seldom reached: few blocks gain, but those much.
  EXPECT_EQ(later(Effect::kViscous, step(Effect::kBumpStop, 0.07, 1.5, 20.0)), Verdict::kYes);
  EXPECT_EQ(later(Effect::kViscous, step(Effect::kBumpStop, 0.02, 1.5, 20.0)), Verdict::kNo);
  EXPECT_EQ(later(Effect::kViscous, step(Effect::kCubicStiffness, 0.04, 2.3, 16.0)), Verdict::kYes);
  EXPECT_EQ(later(Effect::kViscous, step(Effect::kStribeck, 0.04, 2.3, 16.0)), Verdict::kNo);
}

TEST(Rules, ImperfectionsOfWhatIsKnownAreNoEffects) {
  const auto sure = [](Effect effect, double gain) { return step(effect, gain, 10.0, 25.0); };
  EXPECT_EQ(later(Effect::kTimeSkew, sure(Effect::kUnmodelledMode, 0.035)), Verdict::kStop);
  EXPECT_EQ(later(Effect::kTimeSkew, sure(Effect::kUnmodelledMode, 0.08)), Verdict::kYes);
  EXPECT_EQ(later(Effect::kUnmodelledMode, sure(Effect::kTimeSkew, 0.035)), Verdict::kYes);
  EXPECT_EQ(later(Effect::kPreslidingHysteresis, sure(Effect::kProgressiveFriction, 0.03)),
            Verdict::kStop);
  EXPECT_EQ(later(Effect::kPreslidingHysteresis, sure(Effect::kGainError, 0.018)), Verdict::kYes);
  EXPECT_EQ(later(Effect::kBumpStop, sure(Effect::kQuadraticStiffness, 0.02)), Verdict::kStop);
  EXPECT_EQ(later(Effect::kBumpStop, sure(Effect::kViscous, 0.02)), Verdict::kYes);
}

TEST(Rules, ASkewBesideMemoryStandsInNobodysWay) {
  const auto beside = [](Effect known, double gain) {
    return later(known, step(Effect::kTimeSkew, gain, 10.0, 25.0));
  };
  EXPECT_EQ(beside(Effect::kPreslidingHysteresis, 0.05), Verdict::kNo);
  EXPECT_EQ(beside(Effect::kPreslidingHysteresis, 0.08), Verdict::kYes);
  EXPECT_EQ(beside(Effect::kBacklash, 0.19), Verdict::kNo);
  EXPECT_EQ(beside(Effect::kBacklash, 0.21), Verdict::kYes);
}

// Beside a damper of 5 +- 2: turned round by less than two deviations it may be none.
TEST(Rules, WhatJoinsMustNotTurnTheSignOfAnother) {
  Candidate known;
  known.effect = Effect::kViscous;
  known.count = 1;
  known.sign = 1;
  const Model model = Model{}.with(known);
  const auto fit = std::make_unique<ModelFit>();
  fit->covariance(ModelFit::kFirstEffect, ModelFit::kFirstEffect) = 4.0;
  for (const double damping : {5.0, 0.0, -3.9}) {
    fit->theta[ModelFit::kFirstEffect] = damping;
    EXPECT_TRUE(is_plausible(model, *fit)) << damping;
  }
  fit->theta[ModelFit::kFirstEffect] = -4.1;
  EXPECT_FALSE(is_plausible(model, *fit));
}

// Of the mean of both directions, 3 +- 1, and half their difference.
TEST(Rules, NoDirectionOfADamperMayDriveForSure) {
  Candidate known;
  known.effect = Effect::kAsymmetricViscous;
  known.count = 2;
  const Model model = Model{}.with(known);
  const auto fit = std::make_unique<ModelFit>();
  constexpr int kMean = ModelFit::kFirstEffect + 1;
  fit->covariance(kMean, kMean) = 1.0;
  fit->theta[kMean] = 3.0;
  for (const double half : {4.9, -4.9}) {
    fit->theta[ModelFit::kFirstEffect] = half;
    EXPECT_TRUE(is_plausible(model, *fit)) << half;
  }
  for (const double half : {5.1, -5.1}) {
    fit->theta[ModelFit::kFirstEffect] = half;
    EXPECT_FALSE(is_plausible(model, *fit)) << half;
  }
}

TEST(Rules, AStopWithinTheMotionIsTheKinkOfAnUnevenSpring) {
  Grids grids;
  grids.bump_gap[2] = 0.9;
  grids.bump_gap[3] = 1.1;
  Candidate stop;
  stop.effect = Effect::kBumpStop;
  const auto is_kink = [&](Effect beside, std::uint8_t variant) {
    stop.variant = variant;
    return is_kink_of_spring(with(beside), stop, grids);
  };
  EXPECT_TRUE(is_kink(Effect::kAsymmetricStiffness, 2));
  EXPECT_TRUE(is_kink(Effect::kQuadraticStiffness, 2));
  EXPECT_FALSE(is_kink(Effect::kAsymmetricStiffness, 3));
  EXPECT_FALSE(is_kink(Effect::kCubicStiffness, 2));
  stop.effect = Effect::kBacklash;
  EXPECT_FALSE(is_kink(Effect::kAsymmetricStiffness, 2));
}

TEST(Rules, MemoryBesideAnUnevenSpringMustGainMoreThanItsKinkLeaves) {
  Step step;
  step.chosen.effect = Effect::kPreslidingHysteresis;
  step.block_t = 10.0;
  step.coefficient_t = 20.0;
  for (const Effect spring : {Effect::kAsymmetricStiffness, Effect::kQuadraticStiffness}) {
    step.gain = 0.08;
    EXPECT_NE(judge_step(with(spring), false, true, step), Verdict::kYes);
    step.gain = 0.12;
    EXPECT_EQ(judge_step(with(spring), false, true, step), Verdict::kYes);
  }
  step.gain = 0.08;
  EXPECT_EQ(judge_step(with(Effect::kCubicStiffness), false, true, step), Verdict::kYes);
}

TEST(Rules, ALateChannelThatWasSetRightHidesNothing) {
  Candidate late;
  late.effect = Effect::kTimeSkew;  // without a column
  const Step mode = step(Effect::kUnmodelledMode, 0.035, 10.0, 25.0);
  EXPECT_EQ(judge_step(Model{}.with(late), false, true, mode), Verdict::kYes);
}

TEST(Rules, WhatTwoChannelsThatWereSetRightLeaveLooksLikeMemory) {
  Candidate late;
  late.effect = Effect::kTimeSkew;  // without a column
  Candidate other = late;
  other.form = kWheelset1Form;
  const Model one = Model{}.with(late);
  for (const auto& [gain, beside_two] : {std::pair{0.055, false}, std::pair{0.065, true}}) {
    const Step memory = step(Effect::kPreslidingHysteresis, gain, 10.0, 25.0);
    EXPECT_EQ(judge_step(one, false, true, memory), Verdict::kYes);
    EXPECT_EQ(judge_step(one.with(other), false, true, memory) == Verdict::kYes, beside_two);
  }
}

TEST(Rules, ASecondLateChannelMustGainMoreThanTheFirstLeaves) {
  EXPECT_EQ(later(Effect::kTimeSkew, step(Effect::kTimeSkew, 0.05, 10.0, 25.0)), Verdict::kStop);
  EXPECT_EQ(later(Effect::kTimeSkew, step(Effect::kTimeSkew, 0.07, 10.0, 25.0)), Verdict::kYes);
}

TEST(Rules, TwoChannelsMayBeLateBesideTheThird) {
  Candidate late;
  late.effect = Effect::kTimeSkew;
  late.form = kFrameForm;
  Candidate other = late;
  other.form = kWheelset2Form;
  const Model one = Model{}.with(late);
  EXPECT_FALSE(has_room(one, late, true)) << "the same once more";
  EXPECT_TRUE(has_room(one, other, true));
  EXPECT_FALSE(has_room(one, other, false));
  Candidate third = late;
  third.form = kWheelset1Form;
  EXPECT_FALSE(has_room(one.with(other), third, true)) << "all late are none";
  Candidate gain = late;
  gain.effect = Effect::kGainError;
  EXPECT_TRUE(has_room(one.with(other), gain, true));
  gain.form = kWheelset1Form;
  late.effect = Effect::kGainError;
  EXPECT_FALSE(has_room(Model{}.with(late), gain, true)) << "of one channel";
}

TEST(Rules, ALateChannelLooksLikeAWrongGainOfTheSame) {
  Step gain = step(Effect::kGainError, 0.09, 10.0, 25.0);
  gain.chosen.form = kFrameForm;
  EXPECT_EQ(later(Effect::kTimeSkew, gain), Verdict::kStop);  // of the frame, too
  gain.chosen.form = kWheelset2Form;
  EXPECT_EQ(later(Effect::kTimeSkew, gain), Verdict::kYes);
}

TEST(Rules, SpringsMayBeTheProductOfTwoFrictions) {
  Candidate progressive;
  progressive.effect = Effect::kProgressiveFriction;
  const Model both = with(Effect::kPreslidingHysteresis).with(progressive);
  const Step spring = step(Effect::kAsymmetricStiffness, 0.11, 25.0, 40.0);
  EXPECT_EQ(judge_step(both, false, true, spring), Verdict::kStop);
  EXPECT_EQ(later(Effect::kPreslidingHysteresis, spring), Verdict::kYes);
}

bool comes_first(Effect effect, double gain, double block_t, double coefficient_t) {
  return judge_step({}, true, true, step(effect, gain, block_t, coefficient_t)) == Verdict::kYes;
}

// 5 % with ten deviations; it or 2.5 % with four of them in blocks that agree by two; 0.3 % where
// they agree by 3.3, but for a skew.
TEST(Rules, TheFirstIsJudgedByGainAndSignificanceTogether) {
  constexpr Effect kAny = Effect::kViscous;
  EXPECT_TRUE(comes_first(kAny, 0.051, 1.0, 10.1));
  EXPECT_FALSE(comes_first(kAny, 0.049, 1.0, 10.1));
  EXPECT_FALSE(comes_first(kAny, 0.051, 1.0, 9.9));
  for (const double gain : {0.051, 0.026}) {
    EXPECT_TRUE(comes_first(kAny, gain, 2.1, 4.1));
    EXPECT_FALSE(comes_first(kAny, gain, 1.9, 4.1));
    EXPECT_FALSE(comes_first(kAny, gain, 2.1, 3.9));
  }
  EXPECT_FALSE(comes_first(kAny, 0.024, 2.1, 4.1));
  EXPECT_TRUE(comes_first(kAny, 0.0031, 3.4, 0.0));
  EXPECT_FALSE(comes_first(kAny, 0.0029, 3.4, 0.0));
  EXPECT_FALSE(comes_first(kAny, 0.0031, 3.2, 0.0));
  EXPECT_FALSE(comes_first(Effect::kTimeSkew, 0.0031, 3.4, 0.0));
  EXPECT_TRUE(comes_first(Effect::kTimeSkew, 0.026, 2.1, 4.1));
}

TEST(Rules, WhatIsFaintMustBeSure) {
  EXPECT_TRUE(comes_first(Effect::kStribeck, 0.0016, 1.6, 12.1));
  EXPECT_FALSE(comes_first(Effect::kStribeck, 0.0014, 1.6, 12.1));
  EXPECT_FALSE(comes_first(Effect::kStribeck, 0.0016, 1.4, 12.1));
  EXPECT_FALSE(comes_first(Effect::kStribeck, 0.0016, 1.6, 11.9));
  EXPECT_FALSE(comes_first(Effect::kViscous, 0.0016, 1.6, 12.1));
  for (const Effect spring :
       {Effect::kCubicStiffness, Effect::kQuadraticStiffness, Effect::kAsymmetricStiffness}) {
    EXPECT_TRUE(comes_first(spring, 1e-4, 2.6, 4.3));
    EXPECT_FALSE(comes_first(spring, 1e-4, 2.4, 4.3));
    EXPECT_FALSE(comes_first(spring, 1e-4, 2.6, 4.1));
  }
}

// 1.2 % with ten deviations and blocks that agree by 3.5; eight where the gain is 5 %, or 2.5 % in
// blocks that agree by 2.5, of a spring that bends by 2.
TEST(Rules, ALaterOneIsJudgedBothWaysToo) {
  const auto joins = [](Effect effect, double gain, double block_t, double coefficient_t) {
    return later(Effect::kViscous, step(effect, gain, block_t, coefficient_t)) == Verdict::kYes;
  };
  EXPECT_TRUE(joins(Effect::kGainError, 0.013, 3.6, 10.1));
  EXPECT_FALSE(joins(Effect::kGainError, 0.011, 3.6, 10.1));
  EXPECT_FALSE(joins(Effect::kGainError, 0.013, 3.4, 10.1));
  EXPECT_FALSE(joins(Effect::kGainError, 0.013, 3.6, 9.9));
  EXPECT_TRUE(joins(Effect::kGainError, 0.026, 2.6, 8.1));
  EXPECT_FALSE(joins(Effect::kGainError, 0.024, 2.6, 8.1));
  EXPECT_FALSE(joins(Effect::kGainError, 0.026, 2.4, 8.1));
  EXPECT_FALSE(joins(Effect::kGainError, 0.026, 2.6, 7.9));
  EXPECT_TRUE(joins(Effect::kGainError, 0.051, 0.1, 8.1));
  EXPECT_FALSE(joins(Effect::kGainError, 0.049, 0.1, 8.1));
  for (const Effect spring : {Effect::kBumpStop, Effect::kCubicStiffness}) {
    EXPECT_TRUE(joins(spring, 0.026, 2.1, 8.1));
    EXPECT_FALSE(joins(spring, 0.026, 1.9, 8.1));
  }
}

// The least gain of a sure effect, by what it is beside.
TEST(Rules, AGainCountsFromWhatTheKnownEffectsLeave) {
  const auto expect_from = [](const Model& known, Effect effect, double gain) {
    const auto verdict = [&](double share) {
      return judge_step(known, false, true, step(effect, share * gain, 10.0, 25.0));
    };
    EXPECT_EQ(verdict(1.02), Verdict::kYes) << gain;
    EXPECT_NE(verdict(0.98), Verdict::kYes) << gain;
  };
  expect_from(with(Effect::kViscous), Effect::kGainError, 0.012);
  expect_from(with(Effect::kPreslidingHysteresis), Effect::kGainError, 0.015);
  expect_from(with(Effect::kPreslidingHysteresis), Effect::kAsymmetricViscous, 0.035);
  expect_from(with(Effect::kUnmodelledMode), Effect::kGainError, 0.035);
  expect_from(with(Effect::kBumpStop), Effect::kQuadraticStiffness, 0.035);
  expect_from(with(Effect::kViscous), Effect::kBacklash, 0.035);
  expect_from(with(Effect::kTimeSkew), Effect::kTimeSkew, 0.06);
  expect_from(with(Effect::kTimeSkew), Effect::kBacklash, 0.06);
  expect_from(with(Effect::kPreslidingHysteresis), Effect::kTimeSkew, 0.065);
  expect_from(with(Effect::kBacklash), Effect::kTimeSkew, 0.20);  // of the frame
  expect_from(with(Effect::kBacklash), Effect::kGainError, 0.015);
  for (const Effect of_rate : {Effect::kViscous, Effect::kAsymmetricViscous, Effect::kStribeck,
                               Effect::kQuadraticDamping, Effect::kViscoelastic})
    expect_from(with(Effect::kBacklash), of_rate, 0.10);
  for (const Effect spring : {Effect::kAsymmetricStiffness, Effect::kQuadraticStiffness})
    for (const Effect bent : {Effect::kBumpStop, Effect::kCubicStiffness})
      expect_from(with(spring), bent, 0.06);
  expect_from(with(Effect::kTimeSkew), Effect::kGainError, 0.10);
  Candidate progressive;
  progressive.effect = Effect::kProgressiveFriction;
  expect_from(with(Effect::kPreslidingHysteresis).with(progressive), Effect::kQuadraticStiffness,
              0.15);
}

/// Improvements of so many entries whose mean is `t` times its deviation.
double block_t_of(std::size_t entries, double t) {
  const auto before = std::make_unique<ModelFit>();
  const auto after = std::make_unique<ModelFit>();
  const auto n = static_cast<double>(entries);
  for (std::size_t e = 0; e < entries; ++e) {
    const double off = e % 2 == 0 ? 1.0 : -1.0;
    before->held_out_error[e] = off * std::sqrt((n - 1.0) / n) + t / std::sqrt(n);
  }
  return block_t(*before, *after, entries);
}

// Tables of Student's distribution: 2.262, 3.250 and 4.781 with nine degrees of freedom are as rare
// as 1.960, 2.576 and 3.291 of a normal one.
TEST(BlockT, CountsFewEntriesByTheirRarity) {
  for (const auto& [student, normal] :
       {std::pair{2.262, 1.960}, std::pair{3.250, 2.576}, std::pair{4.781, 3.291}}) {
    EXPECT_NEAR(block_t_of(10, student) / normal, 1.0, 0.005);
    EXPECT_NEAR(block_t_of(10, -student) / -normal, 1.0, 0.005);
    EXPECT_NEAR(block_t_of(16, student), student, 1e-9) << "as the rules were calibrated";
  }
  EXPECT_EQ(block_t_of(10, 0.0), 0.0);
}

}  // namespace
}  // namespace dampline::effect

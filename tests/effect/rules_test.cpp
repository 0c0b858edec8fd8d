// SPDX-License-Identifier: MIT
#include "dampline/effect/rules.hpp"

#include <gtest/gtest.h>

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
  EXPECT_EQ(later(Effect::kBacklash, step(Effect::kTimeSkew, 0.05, 10.0, 25.0)), Verdict::kNo);
  EXPECT_EQ(later(Effect::kBacklash, step(Effect::kTimeSkew, 0.08, 10.0, 25.0)), Verdict::kYes);
}

TEST(Rules, ALateChannelThatWasSetRightHidesNothing) {
  Candidate late;
  late.effect = Effect::kTimeSkew;  // without a column
  const Step mode = step(Effect::kUnmodelledMode, 0.035, 10.0, 25.0);
  EXPECT_EQ(judge_step(Model{}.with(late), false, true, mode), Verdict::kYes);
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

}  // namespace
}  // namespace dampline::effect

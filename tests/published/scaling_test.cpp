// SPDX-License-Identifier: MIT
#include "published/phase/scaling.hpp"

#include <gtest/gtest.h>

#include "app/verify/phase/simulated.hpp"

namespace dampline {
namespace {

using sim::OscillatorLaw;

SectionMeans<8> steady(const OscillatorLaw& law, double swing_mps2, double noise, unsigned seed,
                       double rate = 0.8) {
  const sim::SectionSweep sweep{.regimes = {{0.2 * swing_mps2, swing_mps2, rate, 0.0}},
                                .phases = 8,
                                .periods = 90,
                                .skipped_periods = 40,
                                .steps_per_flash = 40,
                                .noise = noise,
                                .seed = seed};
  SectionMeans<8> means;
  for (const sim::StrobedPoint& p : sim::strobe(law, sweep))
    means.add(p.phase, p.point, p.input_mps2);
  return means;
}

ScalingVerdict judge(const OscillatorLaw& law, double noise, unsigned seed) {
  return judge_scaling(steady(law, 1.5, noise, seed), steady(law, 3.0, noise, seed + 1));
}

TEST(Scaling, FindsLinearSystemsProportional) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const ScalingVerdict v = judge({.viscous_per_s = 0.3}, 0.01, 10 * seed);
    EXPECT_EQ(v.state, ScalingState::kProportional);
    EXPECT_NEAR(v.input_ratio, 2.0, 1e-9);
    EXPECT_LT(v.chi2, 3.0);
    EXPECT_LT(v.departure, 4.0 * v.departure_std);
  }
}

TEST(Scaling, FindsFrictionAndCubicSpringsOutOfProportion) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    EXPECT_EQ(judge({.viscous_per_s = 0.3, .friction_mps2 = 0.2}, 0.01, 10 * seed).state,
              ScalingState::kDisproportional);
    EXPECT_EQ(
        judge({.viscous_per_s = 0.3, .friction_mps2 = 0.3, .reversal_m = 5.0}, 0.01, 10 * seed)
            .state,
        ScalingState::kDisproportional);
    EXPECT_EQ(judge({.viscous_per_s = 0.3, .cubic_per_m2s2 = 0.1}, 0.01, 10 * seed).state,
              ScalingState::kDisproportional);
  }
}

TEST(Scaling, RefusesWhatCannotBeCompared) {
  const OscillatorLaw law{.viscous_per_s = 0.3};
  const SectionMeans<8> one = steady(law, 1.5, 0.01, 1);
  EXPECT_EQ(judge_scaling(one, SectionMeans<8>{}).state, ScalingState::kNotEnough);
  EXPECT_EQ(judge_scaling(one, steady(law, 1.52, 0.01, 2)).state, ScalingState::kSameInput);
  SectionMeans<8> still;
  SectionMeans<8> shifted;
  for (int i = 0; i < 80; ++i) {
    still.add(i % 8, {0.1, 0.0, 0.0}, 1.0);
    shifted.add(i % 8, {0.1, 0.0, 0.0}, i % 8 < 4 ? 1.0 : -1.0);
  }
  EXPECT_EQ(judge_scaling(one, still).state, ScalingState::kNoInput);
  EXPECT_EQ(judge_scaling(one, shifted).state, ScalingState::kOtherShape);
}

TEST(Scaling, TakesInputsOfOneShapeWithinFivePercent) {
  // The larger input: twice the smaller, and a share of another shape.
  const auto judged = [](double share) {
    const double other2 = 4.0 * share * share / (1.0 - share * share);
    return judge_input({.small2 = 1.0, .large2 = 4.0 + other2, .both = 2.0});
  };
  EXPECT_EQ(judged(0.049).state, ScalingState::kProportional);
  EXPECT_DOUBLE_EQ(judged(0.049).input_ratio, 2.0);
  EXPECT_EQ(judged(0.051).state, ScalingState::kOtherShape);
}

TEST(Scaling, ComparesInputsThatATenthTellsApart) {
  const auto judged = [](double ratio) {
    return judge_input({.small2 = 1.0, .large2 = ratio * ratio, .both = ratio}).state;
  };
  EXPECT_EQ(judged(1.09), ScalingState::kSameInput);
  EXPECT_EQ(judged(1.11), ScalingState::kProportional);
}

TEST(Scaling, SaysThatNeitherRunMoves) {
  const OscillatorLaw stuck{.friction_mps2 = 5.0};
  EXPECT_EQ(judge_scaling(steady(stuck, 1.5, 0.0, 1), steady(stuck, 3.0, 0.0, 1)).state,
            ScalingState::kNoMotion);
}

}  // namespace
}  // namespace dampline

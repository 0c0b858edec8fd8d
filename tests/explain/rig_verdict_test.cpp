// SPDX-License-Identifier: MIT
// Where a rig's law counts as complete: each bound from either side, everything else well within.
#include <gtest/gtest.h>

#include "app/diagnosis/rig/explanation.hpp"

namespace dampline::test {
namespace {

using app::Signature;
using app::rig::Explanation;

/// A law that leaves so much of the force where noise and resolution make `floor_nmse`, of which
/// the force's noise makes a share.
Explanation leaves(double nmse, double floor_nmse, double noise_share) {
  Explanation out;
  out.final.fit.held_out_nmse = nmse;
  out.final.floor_nmse = floor_nmse;
  out.final.floor_noise_share = noise_share;
  return out;
}

/// A law at its floor, that of the motion, which moved freely over ten segments.
Explanation moves(double nmse_of_equations, double nmse_of_motion) {
  Explanation out = leaves(0.01, 0.01, 0.0);
  out.final.free_run = {
      .segments = 10, .nmse_of_equations = nmse_of_equations, .nmse_of_motion = nmse_of_motion};
  return out;
}

TEST(RigVerdict, AFloorOfMotionIsLessSureThanOneOfNoise) {
  EXPECT_TRUE(leaves(0.0299, 0.01, 0.0).is_complete());
  EXPECT_FALSE(leaves(0.0301, 0.01, 0.0).is_complete());
  EXPECT_TRUE(leaves(0.0149, 0.01, 1.0).is_complete());
  EXPECT_FALSE(leaves(0.0151, 0.01, 1.0).is_complete());
  EXPECT_TRUE(leaves(0.0224, 0.01, 0.5).is_complete());
  EXPECT_FALSE(leaves(0.0226, 0.01, 0.5).is_complete());
}

TEST(RigVerdict, NoFloorExcusesMoreThanNinePercentOverNoise) {
  EXPECT_TRUE(leaves(0.089, 0.05, 0.0).is_complete());
  EXPECT_FALSE(leaves(0.091, 0.05, 0.0).is_complete());
  EXPECT_TRUE(leaves(0.6, 0.5, 1.0).is_complete()) << "a force of which noise makes half";
}

TEST(RigVerdict, NoLawIsHeldToLessThanAHundredThousandth) {
  EXPECT_TRUE(leaves(0.9e-5, 0.0, 0.0).is_complete());
  EXPECT_FALSE(leaves(1.1e-5, 0.0, 0.0).is_complete());
}

TEST(RigVerdict, NoiseIsNothingThatTheStatePredicts) {
  for (double Signature::*share : {&Signature::travel_share, &Signature::surface_share}) {
    Explanation found = leaves(0.01, 0.01, 0.51);
    found.signature.*share = 0.49;
    EXPECT_TRUE(found.is_complete());
    found.signature.*share = 0.51;
    EXPECT_FALSE(found.is_complete());
    found.final.floor_noise_share = 0.49;
    EXPECT_TRUE(found.is_complete()) << "errors of the motion are in step with it";
  }
}

TEST(RigVerdict, ALawMovesAsItsRecordDoes) {
  EXPECT_TRUE(moves(0.9e-3, 0.5).is_complete()) << "by either figures";
  EXPECT_TRUE(moves(0.5, 0.9e-3).is_complete());
  EXPECT_FALSE(moves(1.1e-3, 1.1e-3).is_complete());
  Explanation followed = moves(0.5, 0.5);
  followed.final.free_run.followed = true;
  EXPECT_TRUE(followed.is_complete()) << "to the noise of its deflection";
}

TEST(RigVerdict, MoreThanNoiseIsLeftOfTheMotion) {
  Explanation found = moves(0.5e-3, 0.5e-3);
  found.final.free_run.density_ratio = 5.0;
  EXPECT_FALSE(found.is_complete());
  found.final.floor_noise_share = 0.51;
  EXPECT_TRUE(found.is_complete()) << "the force is noisy";
}

TEST(RigVerdict, WhatIsNotDecidedOrCannotBeIsNotComplete) {
  Explanation found = leaves(0.01, 0.01, 0.0);
  EXPECT_STREQ(found.verdict(), "complete");
  found.steps.emplace_back();
  EXPECT_STREQ(found.verdict(), "explained");
  found.alike = "coulomb, stribeck";
  EXPECT_STREQ(found.verdict(), "partly_explained");
  found.alike.clear();
  found.impossible = "a mass below nothing";
  EXPECT_STREQ(found.verdict(), "partly_explained");
  found.steps.clear();
  EXPECT_STREQ(found.verdict(), "unexplained");
}

}  // namespace
}  // namespace dampline::test

// SPDX-License-Identifier: MIT
#include "published/phase/planarity.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "sim_hw/noise.hpp"
#include "tests/published/sections.hpp"

namespace dampline {
namespace {

using phase_test::planarity;
using phase_test::random_sweep;
using sim::OscillatorLaw;

int declared_nonlinear(const OscillatorLaw& law, double noise, int runs) {
  int count = 0;
  for (int run = 0; run < runs; ++run) {
    const auto points = sim::strobe(law, random_sweep(noise, 500 + static_cast<unsigned>(run)));
    const PlanarityVerdict verdict = planarity(points, noise);
    EXPECT_TRUE(verdict.state == PlanarityState::kLinear ||
                verdict.state == PlanarityState::kNonlinear);
    count += verdict.state == PlanarityState::kNonlinear ? 1 : 0;
  }
  return count;
}

TEST(Planarity, CallsLinearSystemsLinear) {
  for (const double viscous : {0.1, 0.3, 1.0})
    EXPECT_EQ(declared_nonlinear({.viscous_per_s = viscous}, 0.01, 10), 0) << viscous;
}

TEST(Planarity, CallsFrictionAndCubicSpringsNonlinear) {
  EXPECT_EQ(declared_nonlinear({.viscous_per_s = 0.3, .friction_mps2 = 0.2}, 0.01, 10), 10);
  EXPECT_EQ(declared_nonlinear({.friction_mps2 = 1.0, .reversal_m = 0.5}, 0.01, 10), 10);
  EXPECT_EQ(declared_nonlinear({.viscous_per_s = 0.3, .cubic_per_m2s2 = 0.1}, 0.01, 10), 10);
}

TEST(Planarity, FindsTheTermsThatBendTheSection) {
  const OscillatorLaw law{
      .viscous_per_s = 0.3, .friction_mps2 = 0.2, .reversal_m = 100.0, .cubic_per_m2s2 = 0.05};
  const PlanarityVerdict v = planarity(sim::strobe(law, random_sweep(0.0, 7)), 0.0);
  EXPECT_EQ(v.terms, 3);
  EXPECT_NEAR(v.deflection_per_s2.value, -1.0, 1e-9);
  EXPECT_NEAR(v.velocity_per_s.value, -0.3, 1e-9);
  EXPECT_NEAR(v.sign_mps2.value, -0.2, 1e-9);
  EXPECT_NEAR(v.deflection_sign_per_s2.value, -0.002, 1e-9);
  EXPECT_NEAR(v.cubic_per_m2s2.value, -0.05, 1e-9);
}

TEST(Planarity, StatesDeviationsThatHold) {
  const OscillatorLaw law{.viscous_per_s = 0.3, .friction_mps2 = 0.2};
  int inside = 0;
  for (unsigned run = 0; run < 30; ++run) {
    const PlanarityVerdict v = planarity(sim::strobe(law, random_sweep(0.01, 900 + run)), 0.01);
    inside += std::abs(v.velocity_per_s.value + 0.3) < 2.0 * v.velocity_per_s.std ? 1 : 0;
    inside += std::abs(v.cubic_per_m2s2.value) < 2.0 * v.cubic_per_m2s2.std ? 1 : 0;
  }
  EXPECT_GE(inside, 51);  // 57 expected of 60; fewer than 51 once in 400
}

TEST(Planarity, OnePhaseAloneHardlyShowsDryFriction) {
  const OscillatorLaw law{.viscous_per_s = 0.3, .friction_mps2 = 0.2};
  PlanarityTest<0> one;
  PlanarityTest<0> all;
  for (const sim::StrobedPoint& p : sim::strobe(law, random_sweep(0.0, 11))) {
    all.add(p.point, p.phase_rad, p.input_mps2);
    if (p.phase == 0) one.add(p.point, p.phase_rad, p.input_mps2);
  }
  EXPECT_LT(one.verdict().index, all.verdict().index);
  EXPECT_LT(all.verdict().index, 0.03);  // small even so: only the F-test tells
}

TEST(Planarity, WithoutMotionThereIsNothingToTest) {
  PlanarityTest<1> still;
  PlanarityTest<1> stuck{1e-6};
  for (int i = 0; i < 500; ++i) {
    still.add({0.01, 0.0, 0.0}, 0.7 * i);
    stuck.add({0.01, 1e-9, 0.0}, 0.7 * i);
  }
  EXPECT_EQ(still.verdict().state, PlanarityState::kNoMotion);
  EXPECT_EQ(stuck.verdict().state, PlanarityState::kNoMotion);
  EXPECT_EQ(stuck.verdict().slow, 500U);
  EXPECT_EQ(still.verdict().velocity_per_s.std, 0.0);
}

TEST(Planarity, AConstantChannelIsNoMotionAndFewPointsAreNotEnough) {
  PlanarityTest<0> constant;
  PlanarityTest<0> few;
  sim::Random random{1, sim::Stream::kSensors};
  for (int i = 0; i < 200; ++i) constant.add({random.normal(), 0.5, random.normal()}, 0.0);
  for (int i = 0; i < 20; ++i) few.add({random.normal(), random.normal(), random.normal()}, 0.0);
  EXPECT_EQ(constant.verdict().state, PlanarityState::kNoMotion);
  EXPECT_EQ(few.verdict().state, PlanarityState::kNotEnough);
}

// One velocity sign: the jump is a part of the constant, and its column is left out.
TEST(Planarity, NamesNoJumpWhereTheVelocityKeepsItsSign) {
  PlanarityTest<0> test;
  sim::Random random{2, sim::Stream::kSensors};
  for (int i = 0; i < 300; ++i) {
    const double y = random.normal();
    const double v = 1.0 + random.uniform();
    test.add({y, v, -y - 0.2 * v + 0.01 * random.normal()}, 0.0);
  }
  const PlanarityVerdict v = test.verdict();
  EXPECT_EQ(v.state, PlanarityState::kLinear);
  EXPECT_EQ(v.terms, 1);  // the cubic
  EXPECT_EQ(v.sign_mps2.std, 0.0);
  EXPECT_EQ(v.deflection_sign_per_s2.std, 0.0);
  EXPECT_GT(v.cubic_per_m2s2.std, 0.0);
}

TEST(Planarity, CountsWhatIsNoNumber) {
  PlanarityTest<0> test;
  test.add({std::numeric_limits<double>::quiet_NaN(), 1.0, 1.0}, 0.0);
  test.add({1.0, 1.0, std::numeric_limits<double>::infinity()}, 0.0);
  EXPECT_EQ(test.verdict().not_finite, 2U);
  EXPECT_EQ(test.verdict().points, 0U);
}

}  // namespace
}  // namespace dampline

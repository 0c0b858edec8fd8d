// SPDX-License-Identifier: MIT
#include "published/phase/friction_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim_hw/noise.hpp"
#include "tests/published/sections.hpp"

namespace dampline {
namespace {

constexpr double kReversalM = 0.5;
constexpr int kNodes = 33;
using Map = FrictionMap<kNodes>;
using LawFit = FrictionLawFit<kNodes, false>;

double friction(double y) { return std::abs(1.0 + y / kReversalM); }

Map map_of(double noise, std::uint64_t seed) {
  const sim::SectionSweep sweep{.regimes = sim::moving_regimes(),
                                .phases = 8,
                                .periods = 3,
                                .skipped_periods = 0,
                                .steps_per_flash = 40,
                                .start_spread = 3.0,
                                .starts = 24,
                                .noise = noise,
                                .seed = seed};
  const auto points = sim::strobe({.friction_mps2 = 1.0, .reversal_m = kReversalM}, sweep);
  Map map = Map::make({-6.0, 6.0, phase_test::least_speed_mps(points, noise)}).value();
  for (const sim::StrobedPoint& p : points) map.add(p.point, p.input_mps2);
  return map;
}

/// Root of the summed squares of error over that of the true g.
double relative_error(const FrictionCurve<kNodes>& curve) {
  double error = 0.0;
  double size = 0.0;
  for (const FrictionNode& n : curve.nodes) {
    if (!n.resolved) continue;
    const double g = friction(n.deflection_m);
    error += (n.friction_mps2.value - g) * (n.friction_mps2.value - g);
    size += g * g;
  }
  return std::sqrt(error / size);
}

TEST(FrictionMap, FindsFrictionAndSpringTogether) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const auto curve = map_of(0.01, seed).curve();
    EXPECT_EQ(curve.state, FrictionMapState::kReady);
    EXPECT_LT(relative_error(curve), 0.015);
    EXPECT_LT(relative_error(map_of(0.05, seed).curve()), 0.035);
  }
}

TEST(FrictionLaw, FindsItsThreeParameters) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const FrictionLaw law = LawFit::fit(map_of(0.01, seed));
    EXPECT_EQ(law.state, FrictionLawState::kVarying);
    EXPECT_NEAR(law.friction_mps2.value, 1.0, 0.005);
    EXPECT_NEAR(law.reversal_m.value, kReversalM, 0.01);
    EXPECT_NEAR(law.stiffness_per_s2.value, 1.0, 0.005);
  }
}

TEST(FrictionLaw, IsExactWhereTheDataAre) {
  sim::Random random{4, sim::Stream::kSensors};
  Map map = Map::make({-4.0, 4.0, 0.0}).value();
  for (int i = 0; i < 5000; ++i) {
    const double y = 8.0 * random.uniform() - 4.0;
    const double v = random.normal();
    map.add({y, v, 0.3 - 2.0 * y - std::copysign(1.5 * std::abs(1.0 + y / 1.7), v)}, 0.3);
  }
  const FrictionLaw law = LawFit::fit(map);
  EXPECT_NEAR(law.friction_mps2.value, 1.5, 2e-3);
  EXPECT_NEAR(law.reversal_m.value, 1.7, 2e-3);
  EXPECT_NEAR(law.stiffness_per_s2.value, 2.0, 1e-3);
}

/// Friction that does not vary, beside a viscous part.
FrictionMap<9, true> coulomb_map(double noise_mps2, unsigned seed) {
  sim::Random random{seed, sim::Stream::kSensors};
  auto map = FrictionMap<9, true>::make({-2.0, 2.0, 0.0}).value();
  for (int i = 0; i < 4000; ++i) {
    const double y = 4.0 * random.uniform() - 2.0;
    const double v = random.normal();
    const double clean = -y - 0.25 * v - std::copysign(0.7, v);
    map.add({y, v, clean + noise_mps2 * random.normal()}, 0.0);
  }
  return map;
}

TEST(FrictionLaw, GivesNoReversalForFrictionThatDoesNotVary) {
  const FrictionLaw law = FrictionLawFit<9, true>::fit(coulomb_map(0.05, 3));
  EXPECT_EQ(law.state, FrictionLawState::kConstant);
  EXPECT_EQ(law.reversal_m.std, 0.0);
  EXPECT_NEAR(law.friction_mps2.value, 0.7, 4.0 * law.friction_mps2.std);
  EXPECT_NEAR(law.viscous_per_s.value, 0.25, 4.0 * law.viscous_per_s.std);
}

TEST(FrictionMap, StatesDeviationsThatHold) {
  int inside = 0;
  int all = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    for (const FrictionNode& n : coulomb_map(0.05, 50 + seed).curve().nodes) {
      ASSERT_TRUE(n.resolved);
      inside += std::abs(n.friction_mps2.value - 0.7) < 2.0 * n.friction_mps2.std ? 1 : 0;
      inside += std::abs(n.restoring_mps2.value - n.deflection_m) < 2.0 * n.restoring_mps2.std;
      all += 2;
    }
  }
  EXPECT_NEAR(inside, 0.954 * all, 4.0 * std::sqrt(0.954 * 0.046 * all));
}

TEST(FrictionMap, GivesNoNumbersWhereOneVelocitySignIsMissing) {
  sim::Random random{5, sim::Stream::kSensors};
  Map map = Map::make({-1.0, 1.0, 0.0}).value();
  for (int i = 0; i < 4000; ++i) {
    const double y = 2.0 * random.uniform() - 1.0;
    const double v = y > 0.0 ? 1.0 : random.normal();
    map.add({y, v, -y - std::copysign(0.5, v)}, 0.0);
  }
  const auto curve = map.curve();
  for (const FrictionNode& n : curve.nodes) {
    EXPECT_EQ(n.resolved, n.deflection_m < 0.02) << n.deflection_m;
    if (!n.resolved) {
      EXPECT_EQ(n.friction_mps2.std, 0.0);
    } else if (n.deflection_m < -0.05) {
      EXPECT_NEAR(n.friction_mps2.value, 0.5, 1e-3);
    }
  }
}

TEST(FrictionMap, SaysThatTheNodesClipTheMotion) {
  sim::Random random{6, sim::Stream::kSensors};
  Map map = Map::make({-1.0, 1.0, 0.0}).value();
  for (int i = 0; i < 4000; ++i) {
    const double y = 1.3 * (2.0 * random.uniform() - 1.0);
    const double v = random.normal();
    map.add({y, v, -y - std::copysign(0.5, v)}, 0.0);
  }
  EXPECT_EQ(map.curve().state, FrictionMapState::kClipped);
  EXPECT_EQ(LawFit::fit(map).state, FrictionLawState::kNotEnough);
}

TEST(FrictionMap, GivesNothingWithoutMotionOrForNonsense) {
  Map map = Map::make({-1.0, 1.0, 1e-3}).value();
  for (int i = 0; i < 1000; ++i) map.add({0.2, 0.0, 0.0}, 0.1);
  EXPECT_EQ(map.slow(), 1000U);
  EXPECT_EQ(map.curve().state, FrictionMapState::kNotEnough);
  EXPECT_EQ(LawFit::fit(map).state, FrictionLawState::kNotEnough);
  EXPECT_FALSE(Map::make({1.0, 1.0, 0.0}).ok());
  EXPECT_FALSE(Map::make({-1.0, 1.0, -1.0}).ok());
}

}  // namespace
}  // namespace dampline

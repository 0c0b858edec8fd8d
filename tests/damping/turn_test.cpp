// SPDX-License-Identifier: MIT
#include "dampline/damping/turn.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace dampline {
namespace {

constexpr TurnMotion kTurning{
    .velocity_mps = 0.05, .rate_mps = 0.2, .turn_m = 3e-3, .end_mps2 = 0.7};

Turn of_constant(const TurnMotion& motion) {
  TurnMean mean;
  mean.update(motion);
  mean.update(motion);
  return mean.update(motion);
}

TEST(TurnMean, OfAConstantTurnIsThatTurn) {
  const Turn turn = of_constant(kTurning);
  EXPECT_NEAR(turn.spring_m, 2.0 * 3e-3, 1e-12);
  EXPECT_NEAR(turn.push_mps2, 0.7, 1e-12);
}

// s = sign(v d'): which of the dampers is the faster one.
TEST(TurnMean, ChangesItsSignWithTheVelocityAndWithTheRate) {
  for (const double v : {0.05, -0.05}) {
    for (const double rate : {0.2, -0.2}) {
      TurnMotion motion = kTurning;
      motion.velocity_mps = v;
      motion.rate_mps = rate;
      const double s = v * rate > 0.0 ? 1.0 : -1.0;
      EXPECT_NEAR(of_constant(motion).spring_m, s * 2.0 * 3e-3, 1e-12);
      EXPECT_NEAR(of_constant(motion).push_mps2, s * 0.7, 1e-12);
    }
  }
}

// The signs are as smooth as the law's: 1 mm/s of v, half of that of d'.
TEST(TurnMean, IsSmoothAboutARestingDamper) {
  for (const double v : {0.3e-3, 1.0e-3, -2.0e-3}) {
    TurnMotion motion = kTurning;
    motion.velocity_mps = v;
    EXPECT_NEAR(of_constant(motion).push_mps2, 0.7 * smooth_sign(v, 1.0e-3), 1e-12) << v;
  }
  for (const double rate : {0.1e-3, 0.5e-3, -1.0e-3}) {
    TurnMotion motion = kTurning;
    motion.velocity_mps = 2e-3;
    motion.rate_mps = rate;
    const double s = smooth_sign(2e-3, 1.0e-3) * smooth_sign(rate, 0.5e-3);
    EXPECT_NEAR(of_constant(motion).push_mps2, 0.7 * s, 2e-3) << rate;
  }
}

// Both dampers slide one way where v is faster than 2 d' by more than a margin of 10 mm/s.
TEST(TurnMean, IsNothingWhereBothSlideOneWay) {
  TurnMotion motion = kTurning;
  motion.rate_mps = 5e-3;
  for (const auto& [v, share] :
       {std::pair{20e-3, 0.5}, {50e-3, 0.0}, {-20e-3, -0.5}, {5e-3, 1.0}}) {
    motion.velocity_mps = v;
    EXPECT_NEAR(of_constant(motion).push_mps2, 0.7 * share, 1e-4) << v;
  }
  motion.velocity_mps = 23e-3;
  EXPECT_NEAR(of_constant(motion).push_mps2, 0.7 * (0.5 - 0.5 * smooth_sign(3e-3, 3e-3)), 1e-9);
}

// The hat of one sample to either side, over lines between the samples, summed in quarters: 11/16
// and 5/32, where the integrals are 2/3 and 1/6. A mean belongs to the sample before the newest.
TEST(TurnMean, IsTheMeanByAHat) {
  TurnMean mean;
  std::vector<Turn> means;
  for (int n = 0; n < 8; ++n) {
    TurnMotion motion = kTurning;
    motion.turn_m = n == 4 ? 0.5 : 0.0;
    motion.end_mps2 = n == 4 ? 1.0 : 0.0;
    means.push_back(mean.update(motion));
  }
  const std::vector<double> expected{0.0, 0.0, 0.0, 0.0, 5.0 / 32, 11.0 / 16, 5.0 / 32, 0.0};
  for (std::size_t n = 2; n < 8; ++n) {
    EXPECT_NEAR(means[n].spring_m, expected[n], 1e-12) << n;
    EXPECT_NEAR(means[n].push_mps2, expected[n], 1e-12) << n;
  }
}

}  // namespace
}  // namespace dampline

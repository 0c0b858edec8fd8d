// SPDX-License-Identifier: MIT
#include "dampline/estimate/velocity_error.hpp"

#include <gtest/gtest.h>

namespace dampline {
namespace {

constexpr double kExactMps = 2.0e-3;

TEST(VelocityError, OfExactSensorsIsNothing) {
  const VelocityError error{300.0, 15e-3};
  const Estimate level = error.coulomb({8356.0, 12.0}, kExactMps);
  const Estimate spring = error.stiffness({5.26e6, 2e4}, kExactMps);
  EXPECT_EQ(level.value, 8356.0);
  EXPECT_EQ(level.std, 12.0);
  EXPECT_EQ(spring.value, 5.26e6);
  EXPECT_EQ(spring.std, 2e4);
}

/// As far as nobody knows the rate or the motion, nothing is known of the width either.
TEST(VelocityError, ThatIsUnknownCorrectsNothing) {
  for (const VelocityError& error :
       {VelocityError{}, VelocityError{300.0, 0.0}, VelocityError{0.0, 15e-3}}) {
    EXPECT_EQ(error.coulomb({8000.0, 10.0}, 8e-3).value, 8000.0);
    EXPECT_EQ(error.coulomb({8000.0, 10.0}, 8e-3).std, 10.0);
  }
}

/// By hand: w0 = 1.9 + 10 / 27 mm/s, x = (64 - w0^2) / 225, 1 / (1 + 0.27 x) and 1 + 0.3 x.
TEST(VelocityError, TakesTheLevelDownAndTheSpringUp) {
  const VelocityError error{300.0, 15e-3};
  EXPECT_NEAR(error.share(8e-3), 0.26154, 1e-4);
  const Estimate level = error.coulomb({8000.0, 30.0}, 8e-3);
  EXPECT_NEAR(level.value, 8000.0 / 1.070615, 0.5);
  EXPECT_NEAR(level.std, std::hypot(30.0 / 1.070615, 0.3 * 0.070615 * level.value), 0.1);
  const Estimate spring = error.stiffness({5e6, 2e4}, 8e-3);
  EXPECT_NEAR(spring.value, 5e6 * 1.078462, 100.0);
  EXPECT_NEAR(spring.std, std::hypot(2e4 * 1.078462, 0.078462 * spring.value), 100.0);
}

/// Slow sampling makes the law wider by itself, and loses some of the level.
TEST(VelocityError, KnowsWhatSlowSamplingCosts) {
  const VelocityError slow{150.0, 15e-3};
  EXPECT_EQ(slow.share(4.8e-3), 0.0);
  const Estimate level = slow.coulomb({8000.0, 30.0}, 4.8e-3);
  EXPECT_NEAR(level.value, 8000.0 * 1.0165, 0.1);
  EXPECT_NEAR(level.std, std::hypot(30.0 * 1.0165, 0.01155 * level.value), 0.1);
}

}  // namespace
}  // namespace dampline

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "dampline/effect/modes.hpp"

namespace dampline::effect {
namespace {

constexpr double kResonatorStepS = 1.0 / 300.0;

TEST(Resonator, FollowsTheClosedFormOfAStepResponse) {
  const double hz = 9.0;
  const double d = 0.2;
  Resonator resonator{hz, d, kResonatorStepS};
  const double w = 2.0 * std::numbers::pi * hz;
  const double wd = w * std::sqrt(1.0 - d * d);
  resonator.update(0.0);
  // The input reaches 1 over one step: the ramp's response is the integral of the step's.
  const auto ramp_response_rate = [&](double t) {
    if (t <= 0.0) return 0.0;
    const double e = std::exp(-d * w * t);
    return (1.0 - e * (std::cos(wd * t) + d * w / wd * std::sin(wd * t))) / (w * w);
  };
  for (int n = 1; n < 200; ++n) {
    resonator.update(1.0);
    const double t = n * kResonatorStepS;
    const double rate =
        (ramp_response_rate(t) - ramp_response_rate(t - kResonatorStepS)) / kResonatorStepS;
    ASSERT_NEAR(resonator.rate(), rate, 1e-12) << n;
  }
}

TEST(Resonator, BeyondTheCriticalDampingItCreepsToItsEnd) {
  Resonator resonator{12.0, 1.8, kResonatorStepS};
  const double w = 2.0 * std::numbers::pi * 12.0;
  double largest = 0.0;
  for (int n = 0; n < 600; ++n) {
    resonator.update(1.0);
    largest = std::max(largest, resonator.bend());
  }
  EXPECT_NEAR(resonator.bend(), 1.0, 1e-9);
  EXPECT_NEAR(resonator.acceleration(), 0.0, 1e-9);
  // Two real rates w (1.8 +- sqrt(1.8^2 - 1)): the slow one bounds every value from above by 1
  // but for what the damper transmits at first.
  EXPECT_LT(largest, 1.0 + 2.0 * 1.8 / w * 30.0);
}

}  // namespace
}  // namespace dampline::effect

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/verify/phase/simulated.hpp"

namespace dampline {
namespace {

using sim::FrictionOscillator;
using sim::OscillatorDrive;
using sim::OscillatorLaw;

TEST(FrictionOscillator, FollowsTheDampedSinusoidOfALinearSystem) {
  const double damping = 0.15;
  const double rate = std::sqrt(1.0 - damping * damping);
  FrictionOscillator o{{.viscous_per_s = 2.0 * damping}, {}, 0.01, {1.0, 0.0, 0.0}};
  for (int i = 0; i < 3000; ++i) o.step();
  const double t = o.time_s();
  const double fall = std::exp(-damping * t);
  EXPECT_NEAR(o.point().deflection_m,
              fall * (std::cos(rate * t) + damping / rate * std::sin(rate * t)), 1e-9);
}

// Free vibration with dry friction: each half swing is a cosine about -+F/k, so the amplitude falls
// by 2 F/k a half period, until the spring no longer overcomes the friction.
TEST(FrictionOscillator, LosesTheSameAmplitudeEachHalfSwingAndThenSticks) {
  FrictionOscillator o{{.friction_mps2 = 0.1}, {}, 0.001, {1.07, 0.0, 0.0}};
  for (int half = 1; half <= 4; ++half) {
    while (o.time_s() < half * std::numbers::pi - 5e-4) o.step();
    EXPECT_NEAR(std::abs(o.point().deflection_m), 1.07 - 0.2 * half, 1e-6);
  }
  while (o.time_s() < 30.0) o.step();
  EXPECT_TRUE(o.sticks());
  EXPECT_NEAR(std::abs(o.point().deflection_m), 0.07, 1e-9);
  EXPECT_EQ(o.point().accel_mps2, 0.0);
}

// Den Hartog (1931): without stops, the amplitude under a sinusoid is
// sqrt((P / (1 - w^2))^2 - (H U)^2), U = sin(pi / w) / (w (1 + cos(pi / w))).
TEST(FrictionOscillator, HasDenHartogsAmplitudeUnderASinusoid) {
  const double friction = 0.3;
  for (const double w : {0.6, 0.8, 1.3, 1.8}) {
    const double step_s = 2.0 * std::numbers::pi / w / 2000.0;
    FrictionOscillator o{{.friction_mps2 = friction}, {0.0, 1.0, w, 0.0}, step_s};
    double largest = 0.0;
    for (int i = 0; i < 2000 * 400; ++i) {
      o.step();
      if (i > 2000 * 395) largest = std::max(largest, std::abs(o.point().deflection_m));
    }
    const double u = std::sin(std::numbers::pi / w) / (w * (1.0 + std::cos(std::numbers::pi / w)));
    const double free = 1.0 / (1.0 - w * w);
    EXPECT_NEAR(largest, std::sqrt(free * free - friction * friction * u * u), 1e-5) << w;
  }
}

TEST(FrictionOscillator, DoesNotDependOnItsStep) {
  const OscillatorLaw law{
      .viscous_per_s = 0.1, .friction_mps2 = 0.5, .reversal_m = 1.0, .cubic_per_m2s2 = 0.05};
  const OscillatorDrive drive{0.4, 2.0, 0.7, 0.3};
  FrictionOscillator coarse{law, drive, 0.01};
  FrictionOscillator fine{law, drive, 0.0025};
  for (int i = 0; i < 4000; ++i) coarse.step();
  for (int i = 0; i < 16000; ++i) fine.step();
  EXPECT_NEAR(coarse.point().deflection_m, fine.point().deflection_m, 1e-8);
  EXPECT_NEAR(coarse.point().velocity_mps, fine.point().velocity_mps, 1e-8);
}

TEST(FrictionOscillator, SticksForEverWhereTheForceNeverExceedsTheFriction) {
  for (const double reversal : {0.0, 0.5})
    for (const double w : {0.05, 0.12, 0.16, 0.7, 1.0})
      EXPECT_EQ(sim::steady_amplitude({.friction_mps2 = 1.0, .reversal_m = reversal},
                                      {0.0, 1.0, w, 0.0}, 3, 2, 400),
                0.0);
}

}  // namespace
}  // namespace dampline

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/verify/oscillator/simulated.hpp"

namespace dampline::sim {
namespace {

constexpr double kOscillatorStepS = 1e-4;
constexpr BaseMotion kStill{0.0, 0.0, 0.0};

TEST(Oscillator, DecaysAsTheClosedFormOfTheLinearSystemSays) {
  constexpr double kStiffness = 400.0;
  constexpr double kViscous = 4.0;
  Oscillator oscillator{{.viscous_ps = kViscous, .stiffness_ps2 = kStiffness}};
  oscillator.set_motion(0.01, 0.0);
  const double decay = 0.5 * kViscous;
  const double w = std::sqrt(kStiffness - decay * decay);
  for (int i = 1; i <= 20000; ++i) {
    oscillator.step(kStill, kOscillatorStepS);
    const double t = i * kOscillatorStepS;
    const double x = 0.01 * std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t));
    ASSERT_NEAR(oscillator.deflection_m(), x, 1e-12) << t;
  }
}

/// Between reversals the motion is harmonic about -+F/k: each half period takes 2 F / k.
TEST(Oscillator, LosesTwoFrictionWidthsEveryHalfPeriodAndStopsInTheDeadZone) {
  constexpr double kStiffness = 400.0;
  constexpr double kFriction = 0.5;
  constexpr double kWidth = kFriction / kStiffness;
  Oscillator oscillator{{.stiffness_ps2 = kStiffness, .coulomb_mps2 = kFriction}};
  oscillator.set_motion(0.0109, 0.0);
  const double half_period_s = std::numbers::pi / 20.0;
  const auto steps = static_cast<int>(std::lround(half_period_s / kOscillatorStepS));
  double expected = 0.0109;
  for (int half = 0; half < 6; ++half) {
    for (int i = 0; i < steps; ++i) oscillator.step(kStill, half_period_s / steps);
    expected = std::abs(expected) > kWidth ? -(expected - std::copysign(2.0 * kWidth, expected))
                                           : expected;
    ASSERT_NEAR(oscillator.deflection_m(), expected, 1e-9) << half;
  }
  EXPECT_TRUE(oscillator.sticks());
  EXPECT_LT(std::abs(oscillator.deflection_m()), kWidth);
}

TEST(Oscillator, MovesWithItsBaseUntilTheBasePullsHarderThanFriction) {
  Oscillator oscillator{{.stiffness_ps2 = 400.0, .coulomb_mps2 = 0.5}};
  oscillator.set_motion(0.0, 0.0);
  const auto base = [](double t) { return 1.0 * t; };
  double t = 0.0;
  for (int i = 0; i < 4999; ++i, t += kOscillatorStepS) {
    oscillator.step({base(t), base(t + 0.5 * kOscillatorStepS), base(t + kOscillatorStepS)},
                    kOscillatorStepS);
  }
  EXPECT_TRUE(oscillator.sticks());
  EXPECT_DOUBLE_EQ(oscillator.mass_accel_mps2(base(t)), base(t));
  for (int i = 0; i < 2000; ++i, t += kOscillatorStepS) {
    oscillator.step({base(t), base(t + 0.5 * kOscillatorStepS), base(t + kOscillatorStepS)},
                    kOscillatorStepS);
  }
  EXPECT_FALSE(oscillator.sticks());
  // x'' + k x = -(t - 0.5) from rest at 0.5 s.
  const double s = t - 0.5;
  EXPECT_NEAR(oscillator.deflection_m(), -(s - std::sin(20.0 * s) / 20.0) / 400.0, 1e-11);
}

/// Energy balance of a free motion: what is lost went through the dampers.
TEST(Oscillator, LosesTheEnergyThatItsNonlinearTermsDissipate) {
  const OscillatorConfig config{.stiffness_ps2 = 400.0,
                                .cubic_stiffness_pm2s2 = 1e6,
                                .quadratic_viscous_pm2s = 2e4,
                                .coulomb_mps2 = 0.1,
                                .coulomb_slope_ps2 = 20.0};
  Oscillator oscillator{config};
  oscillator.set_motion(0.02, 0.0);
  const auto energy = [&] {
    const double x2 = oscillator.deflection_m() * oscillator.deflection_m();
    const double v = oscillator.velocity_mps();
    return 0.5 * v * v + 0.5 * config.stiffness_ps2 * x2 +
           0.25 * config.cubic_stiffness_pm2s2 * x2 * x2;
  };
  const auto loss = [&] {
    const double x = oscillator.deflection_m();
    const double v = oscillator.velocity_mps();
    return config.quadratic_viscous_pm2s * x * x * v * v +
           (config.coulomb_mps2 + config.coulomb_slope_ps2 * std::abs(x)) * std::abs(v);
  };
  const double start = energy();
  double dissipated = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double before = loss();
    oscillator.step(kStill, 1e-5);
    dissipated += 0.5e-5 * (before + loss());
  }
  EXPECT_GT(dissipated, 0.3 * start);
  EXPECT_NEAR((start - energy()) / start, dissipated / start, 1e-6);
}

}  // namespace
}  // namespace dampline::sim

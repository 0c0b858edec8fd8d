// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "dampline/motion/drift_free_integral.hpp"
#include "tests/steps.hpp"

namespace dampline {
namespace {

constexpr double kRateHz = 300.0;
constexpr double kTurn = 2.0 * std::numbers::pi;

/// Response of the rule at one frequency, over that of an integrator, from its impulse response.
std::complex<double> response_over_integrator(double f_hz) {
  ShortIntegral integral{1.0 / kRateHz};
  const double w = kTurn * f_hz / kRateHz;
  // Differences of the output are finite; the running sum is divided out as 1 - exp(-i w).
  std::complex<double> sum{0.0, 0.0};
  double last = 0.0;
  for (int n = 0; n < 2 * ShortIntegral::kPoints; ++n) {
    const double now = integral.update(n == 0 ? 1.0 : 0.0);
    sum += (now - last) * std::polar(1.0, -w * n);
    last = now;
  }
  const std::complex<double> rule = sum / (1.0 - std::polar(1.0, -w));
  const std::complex<double> integrator =
      std::polar(1.0, -w * ShortIntegral::kDelay) / std::complex<double>{0.0, kTurn * f_hz};
  return rule / integrator;
}

TEST(ShortIntegral, HasTheGainOfAnIntegratorWithin0p4PercentUpTo80Hz) {
  for (const double f_hz : steps(0.5, 80.0, 0.5)) {
    EXPECT_NEAR(std::abs(response_over_integrator(f_hz)), 1.0, 0.0043) << f_hz;
  }
}

TEST(ShortIntegral, IsWithin0p8PercentAt100Hz) {
  EXPECT_NEAR(std::abs(response_over_integrator(100.0)), 1.0, 0.0083);
}

TEST(ShortIntegral, HasThePhaseOfAnIntegratorFourSamplesLate) {
  for (const double f_hz : steps(0.5, 140.0, 0.5)) {
    EXPECT_NEAR(std::arg(response_over_integrator(f_hz)), 0.0, 1e-11) << f_hz;
  }
}

TEST(ShortIntegral, IntegratesAConstantToAnExactRamp) {
  ShortIntegral integral{1.0 / kRateHz};
  double last = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const double now = integral.update(9.81);
    if (n >= ShortIntegral::kPoints) {
      EXPECT_NEAR(now - last, 9.81 / kRateHz, 1e-13);
    }
    last = now;
  }
}

TEST(ShortIntegral, ReBasingShiftsAndChangesNothingElse) {
  ShortIntegral shifted{1.0 / kRateHz};
  ShortIntegral plain{1.0 / kRateHz};
  for (int n = 0; n < 100; ++n) {
    if (n == 50) shifted.rebase(3.0);
    const double x = std::sin(0.3 * n);
    EXPECT_NEAR(shifted.update(x) + (n >= 50 ? 3.0 : 0.0), plain.update(x), 1e-14);
  }
}

TEST(ShortIntegral, ResetForgetsWhatWasSeen) {
  ShortIntegral used{1.0 / kRateHz};
  for (int n = 0; n < 100; ++n) used.update(5.0 + n);
  used.reset();
  ShortIntegral fresh{1.0 / kRateHz};
  for (int n = 0; n < 100; ++n) EXPECT_EQ(used.update(std::cos(n)), fresh.update(std::cos(n)));
}

}  // namespace
}  // namespace dampline

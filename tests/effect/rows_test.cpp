// SPDX-License-Identifier: MIT
#include "dampline/effect/rows.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

namespace dampline::effect {
namespace {

/// Harmonic accelerations: every column is known from the windows' values on sine and cosine.
class HarmonicRows : public testing::Test {
 protected:
  static constexpr double kRateHz = 300.0;
  static constexpr double kHz = 6.0;
  static constexpr double kOmega = 2.0 * std::numbers::pi * kHz;

  HarmonicRows() {
    for (std::int64_t n = 0; n < 1500; ++n) {
      const double t = static_cast<double>(n) / kRateHz;
      Sample s;
      s.tick = n;
      // Constants and ramps must not be seen.
      s.accel_mps2 = {std::cos(kOmega * t) + 0.3 + 0.01 * t, std::sin(kOmega * t) - 0.2, 0.7};
      raw_.push(s);
    }
  }
  /// <psi, f> at a tick, the continuous inner product by its samples.
  template <class F>
  double inner(std::size_t scale, std::int64_t tick, F f) const {
    double sum = 0.0;
    const auto psi = rows_.bank().lumped_psi(scale);
    for (std::size_t i = 0; i < psi.size(); ++i) {
      const auto n = tick - rows_.bank().half(scale) - 1 + static_cast<std::int64_t>(i);
      sum += psi[i] * f(static_cast<double>(n) / kRateHz);
    }
    return sum;
  }

  RawRing raw_{kRateHz, 0.0, false};
  Rows rows_{kRateHz};
};

TEST_F(HarmonicRows, IntegralsAndDerivativesComeWithoutIntegration) {
  for (std::size_t s = 0; s < kScales; ++s) {
    const std::int64_t tick = 700;
    const Row row = rows_.row(s, tick, raw_);
    const double c = inner(s, tick, [](double t) { return std::cos(kOmega * t); });
    const double sn = inner(s, tick, [](double t) { return std::sin(kOmega * t); });
    const double size = std::hypot(c, sn) + 1e-3;
    EXPECT_NEAR(row[kTarget], -c, 5e-5) << s;
    EXPECT_NEAR(row[kFrameRate], -kOmega * sn, 2e-3 * kOmega * size) << s;
    EXPECT_NEAR(row[kFrameOnce], sn / kOmega, 2e-3 / kOmega * size) << s;
    EXPECT_NEAR(row[kFrameTwice], -c / (kOmega * kOmega), 2e-3 / (kOmega * kOmega) * size) << s;
    EXPECT_NEAR(row[kWheelset1Once], -c / kOmega, 2e-3 / kOmega * size) << s;
    EXPECT_NEAR(row[kWheelset1Twice], -sn / (kOmega * kOmega), 2e-3 / (kOmega * kOmega) * size);
    EXPECT_NEAR(row[kWheelset2Once], 0.0, 1e-9) << s;
    EXPECT_NEAR(row[kWheelset2Twice], 0.0, 1e-9) << s;
  }
}

// Half of the turn's spring stands beside each 2 z_b, and what pushes goes off the target.
TEST_F(HarmonicRows, AKnownTurnAddsItsSpringAndItsPush) {
  const std::int64_t tick = 700;
  std::array<Row, kScales> without;
  for (std::size_t s = 0; s < kScales; ++s) without[s] = rows_.row(s, tick, raw_);
  const auto spring_m = [](std::int64_t n) { return 1e-3 * static_cast<double>(n % 17); };
  const auto push_mps2 = [](std::int64_t n) { return 0.2 * static_cast<double>(n % 13); };
  for (std::int64_t n = 0; n < 1000; ++n) rows_.set_turn(n, spring_m(n), push_mps2(n));
  for (std::size_t s = 0; s < kScales; ++s) {
    const Row row = rows_.row(s, tick, raw_);
    double spring = 0.0;
    double push = 0.0;
    std::int64_t n = tick - rows_.bank().half(s);
    for (const double psi : rows_.bank().psi(s)) {
      spring += psi * spring_m(n);
      push += psi * push_mps2(n++);
    }
    EXPECT_NEAR(row[kFrameTwice] - without[s][kFrameTwice], 0.5 * spring, 1e-9) << s;
    EXPECT_NEAR(row[kTarget] - without[s][kTarget], -push, 1e-9) << s;
    EXPECT_EQ(row[kFrameOnce], without[s][kFrameOnce]);
  }
}

TEST_F(HarmonicRows, StandstillIsWeighedByTheWindow) {
  Rows::Sampled zero = Rows::Sampled::Zero();
  for (std::int64_t n = 0; n < 600; ++n) rows_.set(n, zero, n >= 300);
  EXPECT_NEAR(rows_.still_share(3, 300), 0.5, 0.1);
  EXPECT_EQ(rows_.still_share(3, 200), 0.0);
  EXPECT_NEAR(rows_.still_share(3, 400), 1.0, 1e-6);
}

}  // namespace
}  // namespace dampline::effect

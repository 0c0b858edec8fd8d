// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "tests/published/run.hpp"

namespace dampline {
namespace {

using LinearIdentifier = OscillatorIdentifier<LinearTerms>;

/// Feeds a run; `damage` may change the tick and the samples, and returns false where one is lost.
std::unique_ptr<LinearIdentifier> feed_damaged(
    const sim::AccelerometerRun& run,
    const std::function<bool(std::size_t, double& mass, double& base)>& damage) {
  auto identifier = std::make_unique<LinearIdentifier>();
  for (std::size_t n = 0; n < run.mass_mps2.size(); ++n) {
    double mass = run.mass_mps2[n];
    double base = run.base_mps2[n];
    if (damage(n, mass, base)) identifier->update(static_cast<std::int64_t>(n), mass, base);
  }
  identifier->finish();
  return identifier;
}

void expect_accurate(const LinearIdentifier& identifier) {
  const auto estimate = identifier.estimate();
  ASSERT_TRUE(estimate.ok());
  EXPECT_NEAR(estimate.value().value[0], 3.770, 0.01);
  EXPECT_NEAR(estimate.value().value[1], 355.3, 0.3);
}

TEST(AccelerationOnly, LeavesOutAWindowWithAClippedSampleAndCountsIt) {
  const auto run = simulate(kLinearOscillator, 2.85, 31);
  const auto damaged = feed_damaged(run, [](std::size_t n, double& mass, double&) {
    if (n == 5000) mass = 2047.0 * 4.0 * 9.80665 / 4096.0;
    return true;
  });
  EXPECT_EQ(damaged->excluded().clipped, 1);
  EXPECT_EQ(damaged->excluded().total(), 1);
  EXPECT_LT(damaged->memory().blocks(), 11);
  EXPECT_GE(damaged->memory().blocks(), 9);
  expect_accurate(*damaged);
}

TEST(AccelerationOnly, LeavesOutAWindowWithANumberThatIsNoneAndCountsIt) {
  const auto run = simulate(kLinearOscillator, 2.85, 32);
  const auto damaged = feed_damaged(run, [](std::size_t n, double& mass, double& base) {
    if (n >= 5000 && n < 5030) base = std::numeric_limits<double>::quiet_NaN();
    if (n == 9000) mass = std::numeric_limits<double>::infinity();
    return true;
  });
  EXPECT_EQ(damaged->excluded().not_finite, 2);  // a burst counts once
  EXPECT_EQ(damaged->excluded().total(), 2);
  expect_accurate(*damaged);
}

TEST(AccelerationOnly, LeavesOutAWindowWithAGapAndCountsIt) {
  const auto run = simulate(kLinearOscillator, 2.85, 33);
  const auto damaged =
      feed_damaged(run, [](std::size_t n, double&, double&) { return n < 7000 || n >= 7001; });
  EXPECT_EQ(damaged->excluded().gaps, 1);
  EXPECT_EQ(damaged->excluded().total(), 1);
  expect_accurate(*damaged);
}

TEST(AccelerationOnly, TakesARepeatedTickForAGap) {
  const auto run = simulate(kLinearOscillator, 2.85, 33);
  const auto identifier = std::make_unique<LinearIdentifier>();
  feed(*identifier, run, 0, 3000);
  feed(*identifier, run, 2999, 3000);
  EXPECT_EQ(identifier->excluded().gaps, 1);
}

/// Whole blocks before the damage are worth as much as without it.
TEST(AccelerationOnly, KeepsWhatItHasLearnedBeforeTheDamage) {
  const auto run = simulate(kLinearOscillator, 2.85, 34);
  const auto damaged = feed_damaged(run, [](std::size_t n, double&, double&) { return n != 9000; });
  const auto before = std::make_unique<LinearIdentifier>();
  feed(*before, run, 0, 9000);
  before->finish();
  const auto after = std::make_unique<LinearIdentifier>();
  feed(*after, run, 9001, run.mass_mps2.size());
  after->finish();
  before->merge(*after);
  EXPECT_EQ(before->memory().blocks(), damaged->memory().blocks());
  for (std::size_t i = 0; i < 2; ++i) {
    const double value = damaged->estimate().value().value[i];
    EXPECT_NEAR(before->estimate().value().value[i], value, 1e-12 * std::abs(value));
  }
}

TEST(AccelerationOnly, LearnsNothingAtAStandstill) {
  auto run = simulate(kLinearOscillator, 1e-6, 35, 30.0);
  const auto identifier = identify<CoulombTerms>(run);
  EXPECT_EQ(identifier->memory().blocks(), 0);
  EXPECT_EQ(identifier->excluded().quiet, 6);
  EXPECT_FALSE(identifier->estimate().ok());
}

TEST(AccelerationOnly, CountsABlockWithTooFewRowsOutsideTheGate) {
  // 20 Hz: 15 samples a period leave hardly a row of seven samples of one sign.
  auto run = simulate(kLinearOscillator, 1e-6, 36, 30.0);
  for (std::size_t n = 0; n < run.mass_mps2.size(); ++n) {
    run.mass_mps2[n] =
        5.0 * std::sin(2.0 * 3.141592653589793 * 45.0 * static_cast<double>(n) / 300.0);
    run.base_mps2[n] = 0.0;
  }
  const auto identifier = identify<CoulombTerms>(run);
  EXPECT_EQ(identifier->memory().blocks(), 0);
  EXPECT_EQ(identifier->excluded().undetermined, 6);
}

}  // namespace
}  // namespace dampline

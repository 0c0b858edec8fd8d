// SPDX-License-Identifier: MIT
// What must not change an estimate, and what must.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/published/run.hpp"

namespace dampline {
namespace {

using Identifier = OscillatorIdentifier<DuffingTerms>;

sim::OscillatorConfig duffing() {
  sim::OscillatorConfig oscillator = kLinearOscillator;
  oscillator.cubic_stiffness_pm2s2 = kCubic;
  return oscillator;
}

template <class A, class B>
void expect_same(const A& a, const B& b, double tolerance) {
  const auto first = a.estimate();
  const auto second = b.estimate();
  ASSERT_TRUE(first.ok());
  ASSERT_TRUE(second.ok());
  for (std::size_t i = 0; i < first.value().value.size(); ++i) {
    const double value = first.value().value[i];
    EXPECT_NEAR(second.value().value[i], value, tolerance * std::abs(value)) << i;
    EXPECT_NEAR(second.value().std[i] / first.value().std[i], 1.0, 1e3 * tolerance) << i;
  }
}

/// A run whose sensors have another bias, and drift by so much a second.
sim::AccelerometerRun drifting(sim::AccelerometerRun run, double mass_mps3, double base_mps3) {
  for (std::size_t n = 0; n < run.mass_mps2.size(); ++n) {
    const double t = static_cast<double>(n) / 300.0;
    run.mass_mps2[n] += 0.5 + mass_mps3 * t;
    run.base_mps2[n] += -0.3 + base_mps3 * t;
  }
  return run;
}

TEST(AccelerationOnly, ABiasOfBothSensorsChangesNothing) {
  const auto run = simulate(duffing(), 2.65, 21);
  expect_same(*identify<DuffingTerms>(run), *identify<DuffingTerms>(drifting(run, 0.0, 0.0)), 1e-9);
}

TEST(AccelerationOnly, ALinearDriftOfBothSensorsChangesNothing) {
  sim::OscillatorConfig oscillator = kLinearOscillator;
  oscillator.coulomb_mps2 = 0.5;
  const auto run = simulate(oscillator, 3.7, 21);
  expect_same(*identify<CoulombTerms>(run), *identify<CoulombTerms>(drifting(run, -0.004, 0.006)),
              1e-9);
}

/// The second pass takes a drift of the mass's sensor for a deflection: 16 mm/s^2 in a block are 45
/// micrometres of spring, which a cubic term feels a little.
TEST(AccelerationOnly, ALinearDriftHardlyChangesTermsThatAreNotLinear) {
  const auto run = simulate(duffing(), 2.65, 21);
  expect_same(*identify<DuffingTerms>(run), *identify<DuffingTerms>(drifting(run, 0.0, 0.006)),
              1e-9);
  expect_same(*identify<DuffingTerms>(run), *identify<DuffingTerms>(drifting(run, -0.004, 0.006)),
              2e-5);
}

TEST(AccelerationOnly, ARunSplitAtAWindowAndMergedIsTheWholeRun) {
  const auto run = simulate(duffing(), 2.65, 22);
  const auto whole = identify<DuffingTerms>(run);
  // The second part starts with the sixth window, which both need the margin of.
  constexpr std::size_t kSplit = 5 * Identifier::kBlockSamples;
  const auto first = std::make_unique<Identifier>();
  feed(*first, run, 0, kSplit - Identifier::kBlockSamples + Identifier::kWindowSamples);
  first->finish();
  const auto second = std::make_unique<Identifier>();
  feed(*second, run, kSplit, run.mass_mps2.size());
  second->finish();
  EXPECT_EQ(first->memory().blocks(), 5);
  EXPECT_EQ(second->memory().blocks(), 6);
  first->merge(*second);
  EXPECT_EQ(first->memory().blocks(), whole->memory().blocks());
  expect_same(*whole, *first, 1e-12);
}

TEST(AccelerationOnly, TheNumberOfTheFirstTickDoesNotMatter) {
  const auto run = simulate(duffing(), 2.65, 23, 25.0);
  const auto later = std::make_unique<Identifier>();
  for (std::size_t n = 0; n < run.mass_mps2.size(); ++n) {
    later->update(static_cast<std::int64_t>(n) + 4'000'000'000, run.mass_mps2[n], run.base_mps2[n]);
  }
  later->finish();
  EXPECT_EQ(later->excluded().total(), 0);
  expect_same(*identify<DuffingTerms>(run), *later, 1e-15);
}

/// Units: accelerations in another unit scale friction and leave ratios.
TEST(AccelerationOnly, ScaledSignalsScaleFrictionAndNothingElse) {
  sim::OscillatorConfig oscillator = kLinearOscillator;
  oscillator.coulomb_mps2 = 0.5;
  const auto run = simulate(oscillator, 3.7, 24, 25.0);
  auto scaled = run;
  for (double& x : scaled.mass_mps2) x *= 0.5;
  for (double& x : scaled.base_mps2) x *= 0.5;
  const auto a = identify<CoulombTerms>(run)->estimate();
  const auto b = identify<CoulombTerms>(scaled, {.least_velocity_mps = 0.5e-3})->estimate();
  ASSERT_TRUE(a.ok());
  ASSERT_TRUE(b.ok());
  EXPECT_NEAR(b.value().value[0], a.value().value[0], 1e-10);
  EXPECT_NEAR(b.value().value[1], a.value().value[1], 1e-8);
  EXPECT_NEAR(b.value().value[2], 0.5 * a.value().value[2], 1e-11);
}

TEST(AccelerationOnly, SaysNothingBeforeFourBlocks) {
  const auto run = simulate(duffing(), 2.65, 25, 22.0);
  const auto identifier = std::make_unique<Identifier>();
  constexpr std::size_t kThreeWindows = Identifier::kWindowSamples + 2 * Identifier::kBlockSamples;
  feed(*identifier, run, 0, kThreeWindows);
  identifier->finish();
  EXPECT_EQ(identifier->memory().blocks(), 3);
  EXPECT_EQ(identifier->estimate().error(), Errc::kNotReady);
  feed(*identifier, run, kThreeWindows, kThreeWindows + Identifier::kBlockSamples);
  identifier->finish();
  EXPECT_TRUE(identifier->estimate().ok());
}

/// The work of a window is done before the next window is complete, without finish().
TEST(AccelerationOnly, AddsABlockEveryBlockOfSamples) {
  const auto run = simulate(duffing(), 2.65, 26, 40.0);
  Identifier& identifier = *std::make_unique<Identifier>().release();
  const std::unique_ptr<Identifier> owner{&identifier};
  std::vector<std::size_t> added;
  for (std::size_t n = 0; n < run.mass_mps2.size(); ++n) {
    if (identifier.update(static_cast<std::int64_t>(n), run.mass_mps2[n], run.base_mps2[n])) {
      added.push_back(n);
    }
  }
  ASSERT_EQ(added.size(), 8U);
  EXPECT_LT(added[0], Identifier::kWindowSamples + Identifier::kBlockSamples);
  for (std::size_t i = 1; i < added.size(); ++i) {
    EXPECT_EQ(added[i] - added[i - 1], static_cast<std::size_t>(Identifier::kBlockSamples));
  }
}

TEST(AccelerationOnly, RefusesSettingsThatMakeNoSense) {
  EXPECT_TRUE(check(OscillatorIdentifierConfig{}).ok());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(check({.sample_rate_hz = nan}).ok());
  EXPECT_FALSE(check({.sample_rate_hz = 10.0}).ok());
  EXPECT_FALSE(check({.clip_mps2 = 0.0}).ok());
  EXPECT_FALSE(check({.least_velocity_mps = -1.0}).ok());
  EXPECT_FALSE(check({.memory = Memory::kWindow, .memory_blocks = 2.0}).ok());
}

}  // namespace
}  // namespace dampline

// SPDX-License-Identifier: MIT
#include "simulated_rig.hpp"

#include <gtest/gtest.h>

#include "rig_run.hpp"

namespace dampline::test {
namespace {

constexpr double kRigRateHz = 1000.0;
constexpr rig::Terms kDrivenMass{true, true, rig::Branches::kCommon, rig::Branches::kCommon, true};
constexpr SimulatedRig::Sensors kGood{2e-6, 1e-6, 1.0, 0.5};

std::vector<Tone> tones() {
  return {{150.0, 0.73, 0.3}, {120.0, 2.31, 1.1}, {150.0, 4.17, 2.0}, {80.0, 7.9, 0.2}};
}

std::vector<rig::Sample> record(double length_s, const SimulatedRig::Sensors& sensors,
                                std::uint64_t seed) {
  return SimulatedRig{{}, tones()}.record(kRigRateHz, length_s, sensors, seed);
}

TEST(SimulatedRig, ObeysItsEquationAwayFromReversals) {
  const auto data = record(5.0, {}, 1);
  const double h = 1.0 / kRigRateHz;
  std::size_t checked = 0;
  for (std::size_t i = 2; i + 2 < data.size(); ++i) {
    const auto x = [&](std::size_t n) { return data[n].deflection_m; };
    const double v = (x(i + 1) - x(i - 1)) / (2.0 * h);
    if (std::abs(v) < 0.02) continue;
    const double a = (x(i + 1) - 2.0 * x(i) + x(i - 1)) / (h * h);
    const double force = 50.0 * a + 120.0 * v + 2e4 * x(i) + std::copysign(30.0, v) - 4.0;
    EXPECT_NEAR(force, data[i].force_n, 0.5);
    ++checked;
  }
  EXPECT_GT(checked, data.size() / 2);
}

TEST(RigIdentifier, FindsEveryParameterOfADrivenMassWithoutNoise) {
  const RigRun run = run_rig(record(60.0, {}, 1), kRigRateHz, kDrivenMass);
  ASSERT_TRUE(run.snapshot.valid);
  EXPECT_LT(percent(run.of(rig::Parameter::kMovingMass).value, 50.0), 0.1);
  EXPECT_LT(percent(run.of(rig::Parameter::kStiffness).value, 2e4), 0.1);
  EXPECT_LT(percent(run.of(rig::Parameter::kViscous).value, 120.0), 0.5);
  EXPECT_LT(percent(run.of(rig::Parameter::kCoulomb).value, 30.0), 0.5);
  EXPECT_LT(percent(run.of(rig::Parameter::kOffset).value, -4.0), 1.0);
  EXPECT_LT(run.snapshot.held_out_nmse, 1e-5);
}

TEST(RigIdentifier, FindsEveryParameterThroughNoiseAndRounding) {
  const RigRun run = run_rig(record(60.0, kGood, 7), kRigRateHz, kDrivenMass);
  ASSERT_TRUE(run.snapshot.valid);
  EXPECT_LT(percent(run.of(rig::Parameter::kMovingMass).value, 50.0), 0.3);
  EXPECT_LT(percent(run.of(rig::Parameter::kStiffness).value, 2e4), 0.3);
  EXPECT_LT(percent(run.of(rig::Parameter::kViscous).value, 120.0), 1.0);
  EXPECT_LT(percent(run.of(rig::Parameter::kCoulomb).value, 30.0), 1.0);
  EXPECT_LT(percent(run.of(rig::Parameter::kOffset).value, -4.0), 2.0);
}

TEST(RigIdentifier, LowersTheCornerWhenTheDeflectionIsNoisy) {
  const RigRun quiet = run_rig(record(30.0, kGood, 7), kRigRateHz, kDrivenMass);
  const RigRun noisy = run_rig(record(30.0, {3e-4, 1e-6, 1.0, 0.5}, 7), kRigRateHz, kDrivenMass);
  EXPECT_LT(noisy.config.corner_hz, quiet.config.corner_hz);
  EXPECT_LT(percent(noisy.of(rig::Parameter::kMovingMass).value, 50.0), 3.0);
}

TEST(RigIdentifier, StatesHonestStandardDeviations) {
  int within = 0;
  int all = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    auto phases = tones();
    for (Tone& tone : phases) tone.phase_rad += 0.7 * static_cast<double>(seed);
    const auto data =
        SimulatedRig{{}, phases}.record(kRigRateHz, 20.0, {1e-5, 1e-6, 5.0, 0.5}, seed);
    const RigRun run = run_rig(data, kRigRateHz, kDrivenMass);
    const auto check = [&](rig::Parameter parameter, double truth) {
      const Estimate estimate = run.of(parameter);
      within += std::abs(estimate.value - truth) < 2.0 * estimate.std ? 1 : 0;
      ++all;
    };
    check(rig::Parameter::kMovingMass, 50.0);
    check(rig::Parameter::kStiffness, 2e4);
    check(rig::Parameter::kCoulomb, 30.0);
    check(rig::Parameter::kOffset, -4.0);
  }
  EXPECT_GE(within, all * 85 / 100);
  RecordProperty("share_within_two_std", static_cast<int>(100.0 * within / all));
}

TEST(RigIdentifier, ReportsNoSpringWhereNoneWasAskedFor) {
  rig::Terms terms = kDrivenMass;
  terms.stiffness = false;
  const RigRun run = run_rig(record(20.0, kGood, 3), kRigRateHz, terms);
  for (std::size_t i = 0; i < run.snapshot.size; ++i)
    EXPECT_NE(run.snapshot.estimates[i].parameter, rig::Parameter::kStiffness);
  const RigRun with = run_rig(record(20.0, kGood, 3), kRigRateHz, kDrivenMass);
  EXPECT_GT(run.errors.held_out_nmse, 10.0 * with.errors.held_out_nmse);
}

}  // namespace
}  // namespace dampline::test

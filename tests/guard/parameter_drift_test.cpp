// SPDX-License-Identifier: MIT
#include "dampline/guard/parameter_drift.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "dampline/damping/estimator.hpp"
#include "sim_hw/effects/registry.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline {
namespace {

constexpr int kSeconds = 200;

ParameterDrift judge(const sim::SimulationConfig& simulation) {
  EstimatorConfig config;
  config.moving_mass_kg = simulation.truck.moving_mass_kg;
  const auto identifier = std::make_unique<Estimator>(config);
  sim::Simulation record{simulation};
  for (int i = 0; i < kSeconds * sim::kSampleRateHz; ++i)
    identifier->update(sim::to_sample(record.next()));
  identifier->finish();
  const auto statistics = std::make_unique<Statistics>();
  identifier->export_statistics(*statistics);
  return find_parameter_drift(*statistics, Estimator::kBlockS);
}

sim::SimulationConfig laden(std::uint64_t seed) {
  return sim::reference_run(sim::Load::kLaden, 80.0, seed);
}

TEST(ParameterDrift, NamesAStepOfFrictionItsTimeAndSize) {
  sim::SimulationConfig config = laden(31);
  config.truck.drift = {.friction_factor = 1.10, .start_s = 120.0};
  const ParameterDrift drift = judge(config);
  ASSERT_TRUE(drift.found);
  EXPECT_STREQ(name_of(drift.parameter), "coulomb");
  EXPECT_TRUE(drift.step);
  EXPECT_NEAR(drift.time_s, 120.0, drift.interval_s);
  EXPECT_NEAR(drift.change.value, 0.10, 0.02);
  EXPECT_GT(drift.change.std, 0.0);
}

TEST(ParameterDrift, TellsMassFromFrictionAndStiffness) {
  sim::SimulationConfig config = laden(32);
  config.truck.drift = {.mass_factor = 0.92, .start_s = 90.0};
  const ParameterDrift mass = judge(config);
  ASSERT_TRUE(mass.found);
  EXPECT_STREQ(name_of(mass.parameter), "moving_mass");
  EXPECT_NEAR(mass.change.value, -0.08, 0.02);
  config.truck.drift = {.stiffness_factor = 0.85, .start_s = 90.0};
  const ParameterDrift stiffness = judge(config);
  ASSERT_TRUE(stiffness.found);
  EXPECT_STREQ(name_of(stiffness.parameter), "stiffness");
  EXPECT_NEAR(stiffness.change.value, -0.15, 0.03);
}

TEST(ParameterDrift, TellsASlowChangeFromAStep) {
  sim::SimulationConfig config = laden(33);
  config.truck.drift = {.friction_factor = 0.80, .start_s = 0.0, .end_s = kSeconds};
  const ParameterDrift drift = judge(config);
  ASSERT_TRUE(drift.found);
  EXPECT_STREQ(name_of(drift.parameter), "coulomb");
  EXPECT_FALSE(drift.step);
  EXPECT_NEAR(drift.change.value, -0.20, 0.03);
}

TEST(ParameterDrift, SeesNoneInSoundRecordsNorInThoseWithAnEffect) {
  EXPECT_FALSE(judge(laden(34)).found);
  for (const char* effect : {"bump_stop", "unmodelled_mode"}) {
    sim::SimulationConfig config = laden(35);
    ASSERT_FALSE(sim::add_effect(config, effect, {}));
    const ParameterDrift drift = judge(config);
    EXPECT_TRUE(drift.judged);
    EXPECT_FALSE(drift.found) << effect;
  }
}

TEST(ParameterDrift, SaysNothingOfTooFewEntries) {
  const auto statistics = std::make_unique<Statistics>();
  EXPECT_FALSE(find_parameter_drift(*statistics, Estimator::kBlockS).judged);
}

}  // namespace
}  // namespace dampline

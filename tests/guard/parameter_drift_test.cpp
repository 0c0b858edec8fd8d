// SPDX-License-Identifier: MIT
#include "dampline/guard/parameter_drift.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <tuple>

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

// At half the speed the truck sticks more, and the friction of the entries seems to be more.
TEST(ParameterDrift, TakesAnotherSpeedForARide) {
  for (const double speed_kmh : {40.0, 50.0, 100.0}) {
    sim::SimulationConfig config = laden(31);
    config.speed.change_time_s = 100.0;
    config.speed.changed_speed_mps = speed_kmh / 3.6;
    const ParameterDrift drift = judge(config);
    EXPECT_TRUE(drift.judged);
    EXPECT_FALSE(drift.found) << speed_kmh << " km/h: " << drift.change.value;
  }
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

ParameterDrift change_of_mass(double change) {
  ParameterDrift out;
  out.judged = out.found = out.step = true;
  out.parameter = DriftingParameter::kMass;
  out.change = {change, 0.003};
  return out;
}

TEST(HoldAgainstFaults, MakesAMassThatAGainExplainsAFaultOfTheFrame) {
  FaultView faults;
  faults.frame_follow = {.usual = 1.1, .step = 0.05, .step_significance = 6.0};
  ParameterDrift drift = change_of_mass(-0.045);
  hold_against_faults(faults, drift);
  EXPECT_FALSE(drift.found);
  ASSERT_EQ(faults.count, 1U);
  EXPECT_EQ(faults.faults[0].kind, FaultKind::kGainChange);
  EXPECT_EQ(faults.faults[0].channel, FaultChannel::kFrame);
  EXPECT_NEAR(faults.faults[0].size, 4.5, 1e-9);
}

TEST(HoldAgainstFaults, LeavesAMassThatIsOne) {
  for (const double follow : {-0.01, 0.0, 0.012}) {  // a mass moves it by a quarter, its own way
    FaultView faults;
    faults.frame_follow = {.usual = 1.1, .step = follow, .step_significance = 6.0};
    ParameterDrift drift = change_of_mass(-0.045);
    hold_against_faults(faults, drift);
    EXPECT_TRUE(drift.found);
    EXPECT_EQ(faults.count, 0U);
  }
}

TEST(HoldAgainstFaults, FindsNoChangeBesideAFaultOfTime) {
  for (const auto& [kind, channel, expected] :
       {std::tuple{FaultKind::kTimingStep, FaultChannel::kFrame, false},
        std::tuple{FaultKind::kLostSamples, FaultChannel::kWheelset1, false},
        std::tuple{FaultKind::kLostSamples, FaultChannel::kAll, true},
        std::tuple{FaultKind::kSpikes, FaultChannel::kFrame, true}}) {
    FaultView faults;
    faults.faults[faults.count++] = {.kind = kind, .channel = channel};
    ParameterDrift drift = change_of_mass(-0.2);
    drift.parameter = DriftingParameter::kFriction;
    hold_against_faults(faults, drift);
    EXPECT_EQ(drift.found, expected) << name_of(kind);
  }
}

}  // namespace
}  // namespace dampline

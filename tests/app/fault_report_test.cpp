// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/config/config.hpp"
#include "app/identify/truck_run.hpp"
#include "app/report/faults.hpp"
#include "app/run/parameters_json.hpp"
#include "sim_hw/presets.hpp"
#include "sim_hw/record_faults.hpp"

namespace dampline::app {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

RunResult identify(const sim::RecordFaultConfig& faults) {
  const sim::SimulationConfig simulation = sim::reference_run(sim::Load::kLaden, 80.0, 11);
  Config config;
  config.car.moving_mass_kg = simulation.truck.moving_mass_kg;
  TruckRun run{config};
  sim::FaultyRecord record{simulation, faults};
  for (int i = 0; i < 60 * sim::kSampleRateHz; ++i) run.take(sim::to_sample(record.next()));
  return run.finish({}, "simulated");
}

TEST(FaultReport, NamesAFaultInParametersAndInTheReport) {
  sim::RecordFaultConfig faults;
  faults.start_s = 30.0;
  faults.dc_jump_mps2[1] = 1.5;
  const RunResult result = identify(faults);
  ASSERT_EQ(result.faults.list.size(), 1U);
  const RunResult back = from_json(to_json(result), "memory");
  ASSERT_EQ(back.faults.list.size(), 1U);
  const FaultFinding& fault = back.faults.list.front();
  EXPECT_EQ(fault.name, "dc_jump");
  EXPECT_EQ(fault.channel, "wheelset1");
  EXPECT_NEAR(fault.time_s, 30.0, 1.5);
  EXPECT_NEAR(fault.size, 1.5, 0.2);
  EXPECT_EQ(fault.unit, "m/s^2");
  ASSERT_FALSE(fault.spans.empty());
  EXPECT_LE(fault.spans.front().start_s, 30.0);
  EXPECT_GE(fault.spans.back().end_s, 30.0);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("dc_jump (wheelset1)")));
  EXPECT_THAT(fault_section(back), HasSubstr("dc jump"));
  EXPECT_THAT(plot_faults(back).script, HasSubstr("'dc jump, wheelset1' 0"));
}

TEST(FaultReport, SaysThatASoundRecordHasNone) {
  const RunResult result = identify({});
  EXPECT_THAT(result.faults.list, IsEmpty());
  EXPECT_THAT(fault_section(result), HasSubstr("No fault"));
  EXPECT_THAT(plot_faults(result).script, IsEmpty());
}

TEST(FaultReport, KeepsAParameterThatChangedThroughTheFile) {
  RunResult result = identify({});
  result.faults.drift = DriftFinding{"coulomb", true, 150.0, 16.0, 0.2, {12.0, 1.5}};
  const RunResult back = from_json(to_json(result), "memory");
  ASSERT_TRUE(back.faults.drift.has_value());
  EXPECT_EQ(describe_drift(*back.faults.drift),
            "coulomb changed by +12.0 ± 1.5 % at 150 ± 8 s of moving time");
}

}  // namespace
}  // namespace dampline::app

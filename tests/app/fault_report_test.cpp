// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/config/config.hpp"
#include "app/identify/truck_run.hpp"
#include "app/report/plots.hpp"
#include "app/report/sections.hpp"
#include "app/run/json.hpp"
#include "app/text/summary.hpp"
#include "sim_hw/faults.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

RunResult identify(const sim::RecordFaultConfig& faults) {
  const sim::SimulationConfig simulation = sim::reference_run(sim::Load::kLaden, 80.0, 11);
  Config config;
  config.car.moving_mass_kg = simulation.truck.moving_mass_kg;
  TruckRun<kIdentifyParts> run{config};
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
  EXPECT_THAT(figure(plot_faults(back), "faults", ""), HasSubstr(">dc jump, wheelset1</text>"));
  const std::string lanes = figure(plot_faults(result), "faults", "");
  EXPECT_LT(lanes.find(">dc jump, wheelset1</text>"),
            lanes.find(">left out: fault of the data</text>"));
}

TEST(FaultReport, SaysThatASoundRecordHasNone) {
  const RunResult result = identify({});
  EXPECT_THAT(result.faults.list, IsEmpty());
  EXPECT_THAT(fault_section(result), HasSubstr("No fault"));
  EXPECT_THAT(plot_faults(result).panels, IsEmpty());
}

TEST(FaultReport, KeepsAParameterThatChangedThroughTheFile) {
  RunResult result = identify({});
  result.faults.drift = DriftFinding{"coulomb", true, 150.0, 16.0, 0.2, {12.0, 1.5}};
  const RunResult back = from_json(to_json(result), "memory");
  ASSERT_TRUE(back.faults.drift.has_value());
  EXPECT_EQ(describe_drift(*back.faults.drift),
            "coulomb changed by +12.0 ± 1.5 % at 150 ± 8 s of moving time");
}

TEST(FaultReport, KeepsAlarmsAndWhatWasLeftOutThroughTheFile) {
  RunResult result;
  result.kind = "truck";
  result.faults.alarms.push_back({"moving_mass", -30.2, 4210.0, 4450.0});
  result.faults.values_replaced = 7;
  result.faults.samples_spoilt = 900;
  result.faults.values_bridged = 12;
  const RunResult back = from_json(to_json(result), "memory");
  ASSERT_EQ(back.faults.alarms.size(), 1U);
  EXPECT_EQ(describe_alarm(back.faults.alarms.front()),
            "moving_mass changed by -30.2 % since 4210 s, told at 4450 s");
  EXPECT_EQ(back.faults.values_replaced, 7U);
  EXPECT_EQ(back.faults.samples_spoilt, 900U);
  EXPECT_EQ(back.faults.values_bridged, 12U);
  EXPECT_THAT(fault_section(back), HasSubstr("moving_mass changed"));
  EXPECT_THAT(fault_section(back), HasSubstr("900 samples left out"));
  EXPECT_THAT(fault_section(back), Not(HasSubstr("Live alarm")));
  result.live = LiveFigures{};
  EXPECT_THAT(fault_section(result), HasSubstr("Live alarm: 1; on simulated months 0.011 false"));
  EXPECT_THAT(to_json(result), HasSubstr("\"false_alarms_per_1000_h\": 0.011"));
}

TEST(FaultReport, TellsWhatALeapOfTheZeroCosts) {
  sim::RecordFaultConfig faults;
  faults.start_s = 30.0;
  faults.dc_jump_mps2[1] = 1.5;
  const RunResult result = identify(faults);
  EXPECT_GT(result.faults.samples_spoilt, 300U);
  EXPECT_LT(result.faults.samples_spoilt, 1200U);
  ASSERT_FALSE(result.excluded.empty());
  EXPECT_EQ(result.excluded.front().reason, "fault of the data");
  EXPECT_NEAR(result.excluded.front().start_s, 29.0, 2.5);
  const auto spoilt = std::make_pair(std::string{"blocks_spoilt"}, std::uint64_t{2});
  EXPECT_THAT(from_json(to_json(result), "memory").counts, Contains(spoilt));
}

TEST(FaultReport, TakesWhatIsDeclaredFromTheConfiguration) {
  const sim::SimulationConfig simulation = sim::reference_run(sim::Load::kLaden, 80.0, 11);
  const auto names = [&](double speed_mps, const char* leading) {
    Config config;
    config.car.wheelbase_m = simulation.truck.wheelbase_m;
    config.input.speed_mps = speed_mps;
    config.input.leading = leading;
    TruckRun<kIdentifyParts> run{config};
    sim::Simulation record{simulation};
    for (int i = 0; i < 100 * sim::kSampleRateHz; ++i) run.take(sim::to_sample(record.next()));
    std::vector<std::string> out;
    for (const FaultFinding& f : run.finish({}, "simulated").faults.list) out.push_back(f.name);
    return out;
  };
  const double true_mps = simulation.speed.speed_mps;
  EXPECT_THAT(names(true_mps, "wheelset1"), IsEmpty());
  EXPECT_THAT(names(1.02 * true_mps, "wheelset1"), Contains("wrong_sample_rate"));
  EXPECT_THAT(names(true_mps, "wheelset2"), Contains("swapped_channels"));
}

}  // namespace
}  // namespace dampline::app

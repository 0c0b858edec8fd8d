// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/diagnosis/truck/explanation.hpp"
#include "app/diagnosis/truck/verdict.hpp"

namespace dampline::app {
namespace {

DataFaults with(const char* name, const char* channel) {
  DataFaults faults;
  FaultFinding& fault = faults.list.emplace_back();
  fault.name = name;
  fault.channel = channel;
  fault.time_s = 12.0;
  return faults;
}

effect::Explanation explained_by_one_effect(double gain) {
  effect::Explanation explanation;
  explanation.conclusion = effect::Conclusion::kExplained;
  explanation.base.held_out_nmse = 0.2;
  explanation.final.held_out_nmse = 0.2 * (1.0 - gain);
  explanation.step_count = 1;
  explanation.step[0].gain = gain;
  return explanation;
}

TEST(TruckVerdict, IsWrittenToTheExplanation) {
  Explained explained;
  explained.identified.faults = with("clock_drift", "frame");
  explained.identified.faults.drift = DriftFinding{"coulomb", true, 100.0, 8.0, 0.4, {10.0, 1.0}};
  explained.drifts = true;
  explained.explanation.base.held_out_nmse = 0.2;
  const auto json = nlohmann::json::parse(to_json(explained));
  EXPECT_EQ(json.at("verdict"), "partly_explained");
  EXPECT_EQ(json.at("faults").at(0).at("name"), "clock_drift");
  EXPECT_EQ(json.at("faults").at(0).at("time_s"), 12.0);
  const auto& step = json.at("steps").at(0);
  EXPECT_EQ(step.at("effect"), "time_drift");
  EXPECT_EQ(step.at("parameters").at(0).at("name"), "time_drift_coulomb");
  EXPECT_EQ(step.at("parameters").at(0).at("value"), 10.0);
}

TEST(TruckVerdict, LeavesOutWhatIsLessThanSensorsMake) {
  effect::Explanation e = explained_by_one_effect(0.02);
  e.floor_nmse = 0.3;
  e.step[0].held_out_nmse_before = 0.2;
  e.step[0].chosen.effect = effect::Effect::kUnmodelledMode;
  EXPECT_EQ(needless_effect(e), effect::Effect::kUnmodelledMode);
  e.step[0].gain = 0.2;  // much, and the first: the floor may be too high
  EXPECT_EQ(needless_effect(e), effect::Effect::kUnknown);
  e.step[0].gain = 0.02;
  e.floor_nmse = 0.2;
  EXPECT_EQ(needless_effect(e), effect::Effect::kUnknown);
}

TEST(TruckVerdict, LeavesOutALatenessThatMayBeNone) {
  effect::Explanation e = explained_by_one_effect(0.3);
  e.step[0].chosen.effect = effect::Effect::kTimeSkew;
  e.step[0].parameter[0].estimate = {12e-6, 11e-6};
  EXPECT_EQ(needless_effect(e), effect::Effect::kTimeSkew);
  e.step[0].parameter[0].estimate = {120e-6, 11e-6};
  EXPECT_EQ(needless_effect(e), effect::Effect::kUnknown);
}

TEST(TruckVerdict, CountsAParameterThatChangesAsAnEffect) {
  Explained explained;
  explained.drifts = true;
  explained.identified.faults.drift = DriftFinding{"coulomb", false, 0.0, 0.0, 0.75, {-30.0, 1.0}};
  explained.explanation.base.held_out_nmse = 0.4;
  explained.explanation.floor_nmse = 0.09;
  EXPECT_DOUBLE_EQ(left_nmse(explained), 0.1);
  EXPECT_EQ(conclusion_of(explained), effect::Conclusion::kExplained);
  explained.explanation.floor_nmse = 0.03;
  EXPECT_EQ(conclusion_of(explained), effect::Conclusion::kPartlyExplained);
  const auto json = nlohmann::json::parse(to_json(explained));
  EXPECT_DOUBLE_EQ(json.at("final").at("held_out_nmse"), 0.1);
  EXPECT_EQ(json.at("final").at("terms").back(), "time_drift");
  EXPECT_EQ(json.at("steps").at(0).at("note"), "like time_drift, law incomplete");
}

}  // namespace
}  // namespace dampline::app

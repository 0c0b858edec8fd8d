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
  EXPECT_EQ(needless_step(e), 0U);
  e.step[0].gain = 0.2;  // much, and the first: the floor may be too high
  EXPECT_EQ(needless_step(e), 1U);
  e.step[0].gain = 0.02;
  e.floor_nmse = 0.2;
  EXPECT_EQ(needless_step(e), 1U);
}

TEST(TruckVerdict, LeavesOutALatenessThatMayBeNone) {
  effect::Explanation e = explained_by_one_effect(0.3);
  e.step[0].chosen.effect = effect::Effect::kTimeSkew;
  e.step[0].parameter[0].estimate = {12e-6, 11e-6};
  EXPECT_EQ(needless_step(e), 0U);
  e.step[0].parameter[0].estimate = {120e-6, 11e-6};
  EXPECT_EQ(needless_step(e), 1U);
}

TEST(TruckVerdict, OfTwoLateChannelsTheSecondMayBeNone) {
  effect::Explanation e = explained_by_one_effect(0.3);
  e.step_count = 2;
  for (effect::Step& step : {std::ref(e.step[0]), std::ref(e.step[1])}) {
    step.chosen.effect = effect::Effect::kTimeSkew;
    step.gain = 0.3;
    step.parameter[0].estimate = {120e-6, 11e-6};
  }
  Needless known;
  EXPECT_FALSE(take_needless(e, known));
  e.step[1].parameter[0].estimate = {12e-6, 11e-6};
  EXPECT_TRUE(take_needless(e, known));
  EXPECT_TRUE(known.second_late);
  EXPECT_FALSE(known.effect[static_cast<std::size_t>(effect::Effect::kTimeSkew)]);
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

TEST(TruckVerdict, TrustsNoLawBesideWhichAParameterChanges) {
  Explained explained;
  effect::Explanation& e = explained.explanation;
  e = explained_by_one_effect(0.3);
  for (Estimate* each : {&e.base_coulomb_n, &e.final_coulomb_n}) *each = {8000.0, 20.0};
  for (Estimate* each : {&e.base_stiffness_npm, &e.final_stiffness_npm}) *each = {5e6, 1e4};
  const auto reasons = [&] {
    return nlohmann::json::parse(to_json(explained)).at("trust_reasons").dump();
  };
  EXPECT_EQ(reasons().find("not constant"), std::string::npos);
  explained.identified.faults.drift =
      DriftFinding{"moving_mass", true, 80.0, 8.0, 0.03, {-6.0, 0.2}};
  EXPECT_NE(reasons().find("moving_mass changed by -6.0 %"), std::string::npos);
}

// Of 0.2 before and a floor of 0.1 an effect must take a hundredth where 0.15 is left.
TEST(TruckVerdict, TakesBackWhatTakesHardlyAnyOfTheExcess) {
  const auto held_back = [](double taken, double floor_nmse) {
    Explained explained;
    explained.explanation = explained_by_one_effect(taken / 0.2);
    explained.explanation.floor_nmse = floor_nmse;
    hold_back(explained);
    return explained.explanation.step_count == 0;
  };
  EXPECT_TRUE(held_back(0.009, 0.1));
  EXPECT_FALSE(held_back(0.011, 0.1));
  EXPECT_TRUE(held_back(0.003, 0.16)) << "1.23 times the floor, and a thirteenth of the excess";
  EXPECT_FALSE(held_back(0.005, 0.16));
  EXPECT_FALSE(held_back(0.001, 0.17)) << "no more is left than sensors make";
}

Explained seen_with(const Misplacement& misplacement, double left_nmse, double floor_nmse) {
  Explained explained;
  explained.circumstances.faults.misplacement = misplacement;
  explained.explanation.conclusion = effect::Conclusion::kUnexplained;
  explained.explanation.final.held_out_nmse = left_nmse;
  explained.explanation.floor_nmse = floor_nmse;
  return explained;
}

std::string misplaced_by(Explained explained) {
  hold_back(explained);
  const auto list = explained.circumstances.faults.list();
  EXPECT_EQ(explained.withheld, !list.empty());
  return list.empty() ? "" : name_of(list.back().kind);
}

TEST(Misplaced, IsAFrameThatShowsTheDifferenceAndAModelThatLeavesMuch) {
  EXPECT_EQ(misplaced_by(seen_with({.difference = 0.2, .difference_share = 0.4}, 0.12, 0.05)),
            "off_centre");
  EXPECT_EQ(misplaced_by(seen_with({.difference = 0.1, .difference_share = 0.4}, 0.12, 0.05)), "");
  EXPECT_EQ(misplaced_by(seen_with({.difference = 0.2, .difference_share = 0.2}, 0.12, 0.05)), "");
  EXPECT_EQ(misplaced_by(seen_with({.difference = 0.2, .difference_share = 0.4}, 0.09, 0.02)), "")
      << "little is left";
  EXPECT_EQ(misplaced_by(seen_with({.difference = 0.2, .difference_share = 0.4}, 0.12, 0.07)), "")
      << "sensors make as much";
}

// Faint friction makes a truck swing by itself: then nothing is left.
TEST(Misplaced, IsForeignMotionOnlyWhereMuchIsLeft) {
  EXPECT_EQ(misplaced_by(seen_with({.foreign_share = 0.05}, 0.2, 0.05)), "foreign_motion");
  EXPECT_EQ(misplaced_by(seen_with({.foreign_share = 0.5}, 0.001, 0.001)), "");
  EXPECT_EQ(misplaced_by(seen_with({.foreign_share = 0.05}, 0.2, 0.08)), "");
  EXPECT_EQ(misplaced_by(seen_with({.foreign_share = 0.02}, 0.2, 0.05)), "");
  Explained wide = seen_with({.foreign_share = 0.02}, 0.2, 0.05);
  wide.explanation.base.width_mps = 8e-3;
  EXPECT_EQ(misplaced_by(wide), "foreign_motion") << "the velocity is wrong";
}

TEST(Misplaced, IsAGainThatThePowersDoNotShow) {
  const auto named = [](const char* parameter, double gain, double by_power) {
    Explained explained = seen_with({.difference = 0.05, .gain = by_power}, 0.05, 0.04);
    explained.explanation.step_count = 1;
    explained.explanation.step[0].chosen.effect = effect::Effect::kGainError;
    explained.explanation.step[0].parameter[0] = {parameter, {gain, 0.001}};
    return misplaced_by(explained);
  };
  EXPECT_EQ(named("gain_error_wheelset1", 0.05, 0.001), "off_centre");
  EXPECT_EQ(named("gain_error_wheelset1", 0.05, 0.049), "");
  EXPECT_EQ(named("gain_error_wheelset1", -0.05, -0.049), "");
  EXPECT_EQ(named("gain_error_wheelset2", -0.05, 0.05), "");
  EXPECT_EQ(named("gain_error_wheelset2", 0.05, 0.001), "off_centre");
  EXPECT_EQ(named("gain_error_wheelset2", 0.05, -0.048), "");
  EXPECT_EQ(named("gain_error_frame", 0.05, 0.001), "") << "that their powers cannot show";
}

}  // namespace
}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "dampline/damping/estimator.hpp"
#include "dampline/guard/alarm_watch.hpp"
#include "dampline/guard/parameter_drift.hpp"
#include "sim_hw/noise.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline {
namespace {

/// Groups of a level and a stiffness with 1 % of scatter.
class Groups {
 public:
  explicit Groups(std::uint64_t seed) : random_{seed, sim::Stream::kFaults} {}
  bool feed(ChangeWatch& watch, double friction, double stiffness, int count) {
    for (int i = 0; i < count; ++i) {
      if (watch.update(friction * (1.0 + 0.01 * random_.normal()),
                       stiffness * (1.0 + 0.01 * random_.normal()), alarm))
        return true;
    }
    return false;
  }
  ChangeAlarm alarm;

 private:
  sim::Random random_;
};

TEST(ChangeWatch, IsQuietAsLongAsNothingChanges) {
  ChangeWatch watch;
  EXPECT_FALSE(Groups{1}.feed(watch, 0.22, 141.0, 20000));
  EXPECT_NEAR(watch.deviation(0), 0.01, 0.001);
}

TEST(ChangeWatch, NamesWhatChangedAndByHowMuch) {
  struct Case {
    double friction;
    double stiffness;
    DriftingParameter parameter;
    double change;
  };
  for (const Case& c : {Case{0.88, 1.0, DriftingParameter::kFriction, -0.12},
                        Case{1.0, 1.15, DriftingParameter::kStiffness, 0.15},
                        Case{1.4, 1.4, DriftingParameter::kMass, 1.0 / 1.4 - 1.0}}) {
    ChangeWatch watch;
    Groups groups{2};
    ASSERT_FALSE(groups.feed(watch, 1.0, 1.0, 500));
    ASSERT_TRUE(groups.feed(watch, c.friction, c.stiffness, 20));
    EXPECT_EQ(groups.alarm.parameter, c.parameter);
    EXPECT_NEAR(groups.alarm.change, c.change, 0.02);
    EXPECT_NEAR(static_cast<double>(groups.alarm.first_group), 501.0, 2.0);
    EXPECT_LE(groups.alarm.group, 510);
  }
}

TEST(ChangeWatch, DoesNotTakeTwoWrongGroupsForAChange) {
  ChangeWatch watch;
  Groups groups{3};
  ASSERT_FALSE(groups.feed(watch, 1.0, 1.0, 100));
  EXPECT_FALSE(groups.feed(watch, 3.0, 1.0, 2));
  EXPECT_FALSE(groups.feed(watch, 1.0, 1.0, 100));
}

TEST(ChangeWatch, LearnsAnewAfterAnAlarm) {
  ChangeWatch watch;
  Groups groups{4};
  ASSERT_FALSE(groups.feed(watch, 1.0, 1.0, 200));
  ASSERT_TRUE(groups.feed(watch, 0.8, 1.0, 20));
  EXPECT_FALSE(groups.feed(watch, 0.8, 1.0, 1000));
  ASSERT_TRUE(groups.feed(watch, 1.0, 1.0, 20));
  EXPECT_NEAR(groups.alarm.change, 0.25, 0.03);
}

TEST(ChangeWatch, PassesOverGroupsWithoutAValue) {
  ChangeWatch watch;
  ChangeAlarm alarm;
  EXPECT_FALSE(watch.update(std::nan(""), 1.0, alarm));
  EXPECT_FALSE(watch.update(1.0, -1.0, alarm));
  EXPECT_EQ(watch.groups(), 0);
}

/// The groups of a simulated car whose friction falls by 20 % after 7 minutes.
TEST(GroupMeter, MeasuresTheNewestBlocksAlone) {
  auto config = sim::reference_run(sim::Load::kLaden, 80.0, 31);
  config.truck.drift.start_s = 450.0;
  config.truck.drift.friction_factor = 0.8;
  sim::Simulation simulation{config};
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  const auto total = std::make_unique<ScaleFactors>();
  GroupMeter meter;
  GroupMeter::Group group;
  double first = 0.0;
  double last = 0.0;
  double stiffness = 0.0;
  for (int i = 0; i < 620 * sim::kSampleRateHz; ++i) {
    if (!identifier->update(sim::to_sample(simulation.next())).block_closed) continue;
    identifier->export_total(*total);
    if (!meter.update(*total, group)) continue;
    if (first == 0.0) first = group.friction_mps2;
    last = group.friction_mps2;
    stiffness = group.stiffness_ps2;
  }
  constexpr double kCoulombMps2 = 0.5 * (7562.0 + 9150.0) / 37200.0;
  EXPECT_NEAR(first / kCoulombMps2, 1.0, 0.02);
  EXPECT_NEAR(last / kCoulombMps2, 0.8, 0.02);
  EXPECT_NEAR(stiffness / (5.26e6 / 37200.0), 1.0, 0.05);
}

/// Five minutes fix the law and twenty groups of a minute are learnt, 1550 s or so; then the
/// friction of a simulated car falls by 20 %.
TEST(AlarmWatch, SaysWhatChangedAndSinceWhenAndWhenItNoticed) {
  constexpr double kChangeS = 1600.0;
  auto config = sim::reference_run(sim::Load::kLaden, 80.0, 31);
  config.truck.drift.start_s = kChangeS;
  config.truck.drift.friction_factor = 0.8;
  sim::Simulation simulation{config};
  const auto estimator = std::make_unique<Estimator>(EstimatorConfig{});
  const auto watch = std::make_unique<AlarmWatch>(EstimatorConfig{});
  EstimatorConfig forgetting;
  forgetting.memory = Memory::kForgetting;
  const auto silent = std::make_unique<AlarmWatch>(forgetting);
  for (std::int64_t tick = 0; tick < 1860 * sim::kSampleRateHz; ++tick) {
    const UpdateResult result = estimator->update(sim::to_sample(simulation.next()));
    if (!result.block_closed) continue;
    watch->take(result.block, tick, *estimator);
    silent->take(result.block, tick, *estimator);
  }
  ASSERT_EQ(watch->view().count, 1U);
  const AlarmView::Alarm& alarm = watch->view().alarms[0];
  EXPECT_EQ(alarm.parameter, DriftingParameter::kFriction);
  EXPECT_NEAR(alarm.change, -0.2, 0.05) << "its first group held both";
  const auto seconds = [](std::int64_t ticks) {
    return static_cast<double>(ticks) / sim::kSampleRateHz;
  };
  EXPECT_NEAR(seconds(alarm.since_tick), kChangeS, 62.0) << "the group's first tick";
  const double groups = seconds(alarm.tick - alarm.since_tick) / (30.0 * Estimator::kBlockS);
  EXPECT_GE(groups, 2.99);
  EXPECT_NEAR(groups, std::round(groups), 0.01) << "whole groups";
  EXPECT_LE(seconds(alarm.tick), kChangeS + 260.0);
  EXPECT_EQ(silent->view().count, 0U) << "where the sums forget";
}

}  // namespace
}  // namespace dampline

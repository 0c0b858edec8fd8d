// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <tuple>
#include <vector>

#include "dampline/guard/parameter_drift.hpp"

namespace dampline {
namespace {

/// A watch that has learnt twenty groups of friction 2 and stiffness 50, whose logarithms go to and
/// fro by this.
class Learnt {
 public:
  explicit Learnt(double scatter = 0.0, const ChangeAlarmConfig& config = {})
      : watch_{config}, scatter_{scatter} {
    for (std::uint32_t i = 0; i < config.least; ++i) EXPECT_FALSE(give(0.0, 0.0));
  }
  /// One group whose logarithms are off by so much.
  bool give(double friction, double stiffness) {
    const double off = count_++ % 2 == 0 ? scatter_ : -scatter_;
    return watch_.update(2.0 * std::exp(friction + off), 50.0 * std::exp(stiffness + off), alarm);
  }
  /// Groups of this until there is an alarm.
  int until_alarm(double friction, double stiffness, int most = 200) {
    for (int i = 1; i <= most; ++i)
      if (give(friction, stiffness)) return i;
    return 0;
  }
  ChangeWatch& watch() { return watch_; }
  ChangeAlarm alarm{};

 private:
  ChangeWatch watch_;
  double scatter_;
  int count_{0};
};

// What is beyond 6 % adds up to 15 %; one group adds 5 % at most.
TEST(ChangeAlarmRules, SumsWhatIsBeyondTheAllowance) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(Learnt{}.until_alarm(sign * 0.059, 0.0), 0);
    EXPECT_EQ(Learnt{}.until_alarm(sign * 0.071, 0.0), 14);
    EXPECT_EQ(Learnt{}.until_alarm(sign * 0.0911, 0.0), 5);
    EXPECT_EQ(Learnt{}.until_alarm(sign * 0.1, 0.0), 4);
    EXPECT_EQ(Learnt{}.until_alarm(sign * 0.12, 0.0), 3);
    EXPECT_EQ(Learnt{}.until_alarm(sign * 3.0, 0.0), 3);
    EXPECT_EQ(Learnt{}.until_alarm(0.0, sign * 0.0911), 5);
  }
}

TEST(ChangeAlarmRules, FallsBackWhileNothingIsBeyond) {
  Learnt learnt;
  for (int round = 0; round < 20; ++round) {
    EXPECT_FALSE(learnt.give(0.5, 0.0));
    EXPECT_FALSE(learnt.give(0.5, 0.0));
    EXPECT_FALSE(learnt.give(0.0, 0.0));
    EXPECT_FALSE(learnt.give(0.0, 0.0));
  }
  EXPECT_EQ(learnt.until_alarm(0.5, 0.0), 3);
}

TEST(ChangeAlarmRules, SaysWhatChangedByHowMuchAndSinceWhen) {
  for (const auto& [friction, stiffness, parameter, change] :
       {std::tuple{0.2, 0.0, DriftingParameter::kFriction, std::expm1(0.2)},
        std::tuple{-0.2, 0.0, DriftingParameter::kFriction, std::expm1(-0.2)},
        std::tuple{0.0, 0.2, DriftingParameter::kStiffness, std::expm1(0.2)},
        std::tuple{0.2, 0.11, DriftingParameter::kMass, std::expm1(-0.155)},
        std::tuple{-0.2, -0.2, DriftingParameter::kMass, std::expm1(0.2)},
        std::tuple{0.2, 0.09, DriftingParameter::kFriction, std::expm1(0.2)},
        std::tuple{0.09, 0.2, DriftingParameter::kStiffness, std::expm1(0.2)},
        std::tuple{0.2, -0.2, DriftingParameter::kFriction, std::expm1(0.2)}}) {
    Learnt learnt;
    for (int i = 0; i < 7; ++i) EXPECT_FALSE(learnt.give(0.0, 0.0));
    ASSERT_EQ(learnt.until_alarm(friction, stiffness), 3);
    EXPECT_EQ(learnt.alarm.parameter, parameter) << friction << ", " << stiffness;
    EXPECT_NEAR(learnt.alarm.change, change, 1e-9);
    EXPECT_EQ(learnt.alarm.first_group, 28);
    EXPECT_EQ(learnt.alarm.group, 30);
  }
}

TEST(ChangeAlarmRules, AllowsFourDeviationsOfTheGroups) {
  // To and fro by 0.03: a deviation of 0.03 sqrt(20 / 19), four of them are 0.123.
  Learnt learnt{0.03};
  EXPECT_NEAR(learnt.watch().deviation(0), 0.03 * std::sqrt(20.0 / 19.0), 1e-9);
  EXPECT_EQ(learnt.until_alarm(0.08, 0.0), 0);
  EXPECT_GT(Learnt{0.03}.until_alarm(0.16, 0.0), 3);
  EXPECT_EQ(Learnt{0.03}.until_alarm(0.5, 0.0), 3);
}

TEST(ChangeAlarmRules, LearnsSoManyGroupsAndNoMore) {
  Learnt learnt{0.0, {.learn = 30}};
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(learnt.give(0.05, 0.0));
  const double deviation = learnt.watch().deviation(0);
  EXPECT_NEAR(deviation, 0.05 * std::sqrt(20.0 * 10.0 / 30.0 / 29.0), 1e-9);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(learnt.give(0.05, 0.0));
  EXPECT_EQ(learnt.watch().deviation(0), deviation);
  EXPECT_EQ(learnt.watch().groups(), 130);
}

TEST(ChangeAlarmRules, KnowsNoDeviationOfOneGroup) {
  ChangeWatch watch;
  ChangeAlarm alarm;
  EXPECT_FALSE(watch.update(1.0, 1.0, alarm));
  EXPECT_EQ(watch.deviation(1), 0.0);
  EXPECT_FALSE(watch.update(1.0, std::exp(0.2), alarm));
  EXPECT_NEAR(watch.deviation(1), 0.1 * std::sqrt(2.0), 1e-9);
  EXPECT_FALSE(watch.update(0.0, 1.0, alarm));
  EXPECT_FALSE(watch.update(1.0, 0.0, alarm));
  EXPECT_EQ(watch.groups(), 2) << "groups without a value are passed over";
}

TEST(ChangeAlarmRules, LearnsAnewAfterAnAlarm) {
  Learnt learnt;
  ASSERT_EQ(learnt.until_alarm(0.3, 0.0), 3);
  EXPECT_EQ(learnt.watch().deviation(0), 0.0);
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(learnt.give(0.3, 0.0));
  EXPECT_EQ(learnt.until_alarm(0.3, 0.0), 0);
  EXPECT_EQ(learnt.until_alarm(0.0, 0.0), 3);
  EXPECT_NEAR(learnt.alarm.change, std::expm1(-0.3), 1e-9);
}

// Of a change that crept over more groups than are kept the newest 64 tell its size.
TEST(ChangeAlarmRules, TellsTheSizeOfASlowChangeByTheNewestGroups) {
  Learnt learnt{0.0, {.learn = 20}};
  int groups = 0;
  while (!learnt.give(0.0605 + 1e-5 * groups, 0.0)) ASSERT_LT(++groups, 400);
  EXPECT_GT(groups, 70);
  EXPECT_NEAR(learnt.alarm.change, std::expm1(0.0605 + 1e-5 * (groups - 31.5)), 1e-6);
}

ParameterDrift drift_of(DriftingParameter parameter, double change, bool step) {
  ParameterDrift out;
  out.judged = out.found = true;
  out.step = step;
  out.time_s = 33.0;
  out.parameter = parameter;
  out.change = {change, 0.003};
  return out;
}

/// Whether a mass that changed by -5 % is a gain of the frame's sensor.
bool is_gain(const FrameFollow& follow, bool step) {
  FaultView faults;
  faults.frame_follow = follow;
  ParameterDrift drift = drift_of(DriftingParameter::kMass, -0.05, step);
  hold_against_faults(faults, drift);
  EXPECT_EQ(faults.count, drift.found ? 0U : 1U);
  if (faults.count > 0) {
    EXPECT_EQ(faults.faults[0].time_s, 33.0);
    EXPECT_EQ(faults.faults[0].last_s, 33.0);
    EXPECT_EQ(faults.faults[0].count, 1U);
    EXPECT_STREQ(faults.faults[0].unit, "%");
  }
  return !drift.found;
}

// Where the frame follows by four tenths of it, or a gain is not excluded by two deviations.
TEST(HoldAgainstFaults, TellsAGainFromAMassByWhatTheFrameFollows) {
  EXPECT_TRUE(is_gain({.step = 0.021, .step_significance = 2.1}, true));
  EXPECT_FALSE(is_gain({.step = 0.019, .step_significance = 2.1}, true));
  EXPECT_TRUE(is_gain({.step = 0.021, .step_significance = 1.9}, true));
  EXPECT_TRUE(is_gain({.step = 0.018, .step_significance = 0.9}, true));
  EXPECT_FALSE(is_gain({.step = -0.012, .step_significance = -1.2}, true)) << "as a mass moves it";
  EXPECT_TRUE(is_gain({.step = -0.012, .step_significance = -0.3}, true)) << "tells nothing";
  EXPECT_FALSE(is_gain({}, true)) << "not known";
  EXPECT_TRUE(is_gain({.trend = 0.021, .trend_significance = 2.1}, false));
  EXPECT_FALSE(is_gain({.step = 0.021, .step_significance = 2.1}, false));
  EXPECT_FALSE(is_gain({.trend = 0.021, .trend_significance = 2.1}, true));
  FaultView faults;
  faults.frame_follow = {.step = 0.05, .step_significance = 6.0};
  ParameterDrift friction = drift_of(DriftingParameter::kFriction, -0.05, true);
  hold_against_faults(faults, friction);
  EXPECT_TRUE(friction.found);
  ParameterDrift none = drift_of(DriftingParameter::kMass, -0.05, true);
  none.found = false;
  hold_against_faults(faults, none);
  EXPECT_EQ(faults.count, 0U);
}

TEST(HoldAgainstFaults, KnowsWhichFaultsMoveParameters) {
  const auto stays = [](FaultKind kind, FaultChannel channel) {
    FaultView faults;
    faults.faults[faults.count++] = {.kind = FaultKind::kSpikes};
    faults.faults[faults.count++] = {.kind = kind, .channel = channel};
    ParameterDrift drift = drift_of(DriftingParameter::kStiffness, 0.2, true);
    hold_against_faults(faults, drift);
    return drift.found;
  };
  for (std::size_t k = 0; k < kFaultKinds; ++k) {
    const auto kind = static_cast<FaultKind>(k);
    const bool by_channel = kind == FaultKind::kLostSamples || kind == FaultKind::kRepeatedSamples;
    const bool moves = by_channel || kind == FaultKind::kTimingStep ||
                       kind == FaultKind::kClockDrift || kind == FaultKind::kGainChange ||
                       kind == FaultKind::kSwappedChannels || kind == FaultKind::kWrongPolarity ||
                       kind == FaultKind::kIdenticalChannels;
    EXPECT_EQ(stays(kind, FaultChannel::kFrame), !moves) << name_of(kind);
    EXPECT_EQ(stays(kind, FaultChannel::kAll), !moves || by_channel) << name_of(kind);
  }
}

}  // namespace
}  // namespace dampline

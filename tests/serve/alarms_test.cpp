// SPDX-License-Identifier: MIT
#include "app/alarm/alarms.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "app/alarm/program.hpp"
#include "app/error.hpp"

namespace dampline::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

RunResult level(double time_s, double coulomb_n, double std_n = 10.0) {
  RunResult out;
  out.trust = Trust::kTrusted;
  out.duration_s = time_s;
  out.parameters.push_back({"coulomb", coulomb_n, std_n, "N"});
  return out;
}

AlarmSettings below(double limit_n, double hold_s) {
  AlarmSettings out;
  out.coulomb_below_n = limit_n;
  out.hold_s = hold_s;
  return out;
}

TEST(Alarms, RaiseWhatLastsAndClearBehindTheHysteresis) {
  Alarms alarms{below(6000.0, 20.0)};
  EXPECT_TRUE(alarms.look(level(0.0, 5900.0)).empty());
  EXPECT_TRUE(alarms.look(level(10.0, 5900.0)).empty());
  const auto raised = alarms.look(level(20.0, 5900.0));
  ASSERT_EQ(raised.size(), 1U);
  EXPECT_EQ(raised[0].kind(), hal::EventKind::kAlarmRaised);
  EXPECT_EQ(raised[0].watch.name, "coulomb_below");
  EXPECT_EQ(raised[0].watch.since_s, 0.0);
  EXPECT_TRUE(alarms.any_raised());
  // Between the limit and 2 % above it: it stays, however long.
  for (double t = 30.0; t < 200.0; t += 10.0) EXPECT_TRUE(alarms.look(level(t, 6100.0)).empty());
  EXPECT_TRUE(alarms.look(level(200.0, 6130.0)).empty());
  EXPECT_TRUE(alarms.look(level(210.0, 6130.0)).empty());
  const auto cleared = alarms.look(level(220.0, 6130.0));
  ASSERT_EQ(cleared.size(), 1U);
  EXPECT_EQ(cleared[0].kind(), hal::EventKind::kAlarmCleared);
  EXPECT_FALSE(alarms.any_raised());
}

TEST(Alarms, AreNotRaisedByWhatPassesOrIsWithinTheDeviation) {
  Alarms alarms{below(6000.0, 20.0)};
  EXPECT_TRUE(alarms.look(level(0.0, 5900.0)).empty());
  EXPECT_TRUE(alarms.look(level(10.0, 6200.0)).empty());
  EXPECT_TRUE(alarms.look(level(20.0, 5900.0)).empty());
  EXPECT_TRUE(alarms.look(level(30.0, 5900.0)).empty());
  Alarms uncertain{below(6000.0, 0.0)};
  EXPECT_TRUE(uncertain.look(level(0.0, 5900.0, 150.0)).empty());
  RunResult untrusted = level(0.0, 5000.0);
  untrusted.trust = Trust::kNotIdentified;
  EXPECT_TRUE(uncertain.look(untrusted).empty());
  EXPECT_EQ(uncertain.look(level(0.0, 5900.0)).size(), 1U);
}

TEST(Alarms, AboveIsTheMirrorImageOfBelow) {
  AlarmSettings settings;
  settings.coulomb_above_n = 9000.0;
  settings.hold_s = 0.0;
  Alarms alarms{settings};
  EXPECT_TRUE(alarms.look(level(0.0, 9005.0)).empty());
  EXPECT_EQ(alarms.look(level(1.0, 9020.0)).size(), 1U);
  EXPECT_TRUE(alarms.look(level(2.0, 8900.0)).empty());
  EXPECT_EQ(alarms.look(level(3.0, 8800.0)).size(), 1U);
}

TEST(Alarms, AFaultIsRaisedByItsNameAndClearedSomeTimeAfterItWasLastSeen) {
  AlarmSettings settings;
  settings.faults = {"clipping", "all"};
  settings.hold_s = 0.0;
  Alarms alarms{settings};
  RunResult result = level(100.0, 8000.0);
  result.faults.list.push_back({"spikes", "frame", 90.0, 95.0, 1.0, "m/s^2", 3, {}});
  const auto first = alarms.look(result);
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first[0].watch.name, "fault_all");
  EXPECT_EQ(first[0].number, 1U);
  result.duration_s = 200.0;
  EXPECT_EQ(alarms.look(result).size(), 1U);
  EXPECT_FALSE(alarms.any_raised());
}

TEST(Alarms, ThePercentagesWantAReference) {
  AlarmSettings settings;
  settings.below_percent = 10.0;
  EXPECT_THAT([&] { Alarms{settings}; }, ThrowsMessage<UsageError>(HasSubstr("[alarm] reference")));
  settings.reference = "/nonexistent.run";
  EXPECT_THAT([&] { Alarms{settings}; }, ThrowsMessage<UsageError>(HasSubstr("nonexistent")));
}

TEST(AlarmProgram, GetsItsWordsAsTheyAreAndNoShellReadsThem) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("alarm_{}", ::getpid());
  std::filesystem::create_directory(folder);
  const auto script = folder / "on alarm";
  std::ofstream{script} << "#!/bin/sh\nfor word; do echo \"$word\"; done > '"
                        << (folder / "part").string() << "'\nmv '" << (folder / "part").string()
                        << "' '" << (folder / "words").string() << "'\n";
  std::filesystem::permissions(script, std::filesystem::perms::owner_all);
  AlarmProgram program{{script.string(), "own; touch oops", "$(id)"}};
  AlarmChange change{{"coulomb_below", true, 5900.0, 6000.0, "N", 3.0}, 0};
  ASSERT_TRUE(program.start(change, 12.5));
  for (int i = 0; i < 500 && program.running() > 0; ++i) {
    program.collect();
    std::this_thread::sleep_for(std::chrono::milliseconds{10});
  }
  EXPECT_EQ(program.running(), 0U);
  std::ifstream in{folder / "words"};
  std::vector<std::string> words;
  for (std::string line; std::getline(in, line);) words.push_back(line);
  EXPECT_THAT(words, ElementsAre("own; touch oops", "$(id)", "coulomb_below", "raised", "5900",
                                 "6000", "N", "12.5"));
  std::filesystem::remove_all(folder);
}

TEST(AlarmProgram, IsRefusedWhereItCannotBeRun) {
  EXPECT_THROW(AlarmProgram{{"true"}}, UsageError);
  EXPECT_THROW(AlarmProgram{{"/etc/passwd"}}, UsageError);
}

TEST(AlarmProgram, IsNotStartedWithoutEnd) {
  AlarmProgram program{{"/bin/sh", "-c", "sleep 0.2"}};
  const AlarmChange change{{"drift", true, {}, {}, "%", {}}, 0};
  for (std::size_t i = 0; i < AlarmProgram::kMostRunning; ++i)
    EXPECT_TRUE(program.start(change, 0.0));
  EXPECT_FALSE(program.start(change, 0.0));
  EXPECT_EQ(program.failures(), 1U);
  for (int i = 0; i < 500 && program.running() > 0; ++i) {
    program.collect();
    std::this_thread::sleep_for(std::chrono::milliseconds{10});
  }
  EXPECT_TRUE(program.start(change, 0.0));
}

}  // namespace
}  // namespace dampline::app

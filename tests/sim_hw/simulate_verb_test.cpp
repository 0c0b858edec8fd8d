// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "app/error.hpp"
#include "app/verbs/simulate.hpp"
#include "sim_hw/writers.hpp"

namespace dampline::app {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::string content(const fs::path& file) {
  std::stringstream text;
  text << std::ifstream{file}.rdbuf();
  return text.str();
}

class SimulateVerb : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path{::testing::TempDir()} / (std::string{"dampline_simulate_"} + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  SimulateOptions options(const std::string& out) const {
    SimulateOptions o;
    o.duration_s = 2.0;
    o.out = (folder_ / out).string();
    o.quiet = true;
    return o;
  }
  fs::path folder_;
};

std::string usage_error(const SimulateOptions& options) {
  try {
    static_cast<void>(simulate(options));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(SimulateVerb, WritesThreeFramesPerSample) {
  const SimulateOptions o = options("a.log");
  EXPECT_EQ(simulate(o), 0);
  const std::string text = content(o.out);
  EXPECT_EQ(std::ranges::count(text, '\n'), 1800);
  EXPECT_THAT(text, ::testing::StartsWith("(1700000000.000"));
}

TEST_F(SimulateVerb, ChoosesCsvByTheSuffix) {
  const SimulateOptions o = options("a.csv");
  EXPECT_EQ(simulate(o), 0);
  const std::string text = content(o.out);
  EXPECT_EQ(std::ranges::count(text, '\n'), 601);
  EXPECT_THAT(text, ::testing::StartsWith("time_s,frame_accel_mps2,"));
}

TEST_F(SimulateVerb, WritesTheSameBytesForTheSameSeed) {
  SimulateOptions o = options("a.log");
  o.force = true;
  ASSERT_EQ(simulate(o), 0);
  const std::string first = content(o.out);
  ASSERT_EQ(simulate(o), 0);
  EXPECT_EQ(content(o.out), first);
  o.seed = 2;
  ASSERT_EQ(simulate(o), 0);
  EXPECT_NE(content(o.out), first);
}

TEST_F(SimulateVerb, WritesTruthDbcAndAConfigurationThatNamesTheDbc) {
  SimulateOptions o = options("a.log");
  o.truth = (folder_ / "truth.csv").string();
  o.dbc = (folder_ / "sensors.dbc").string();
  o.config = (folder_ / "car.toml").string();
  o.load = "empty";
  o.effects = {"viscous", "stribeck:share=0.2"};
  EXPECT_EQ(simulate(o), 0);
  EXPECT_EQ(std::ranges::count(content(o.truth), '\n') - std::ranges::count(content(o.truth), '#'),
            601);
  EXPECT_THAT(content(o.dbc), HasSubstr("BO_ 786 WHEELSET_2: 4"));
  EXPECT_THAT(content(o.config), HasSubstr("moving_mass_kg = 9700.0\n"));
  EXPECT_THAT(content(o.config), HasSubstr("dbc = \"sensors.dbc\"\n"));
  EXPECT_THAT(content(o.config), HasSubstr("frame_accel = \"TRUCK_FRAME.ACCEL_Z\"\n"));
}

TEST_F(SimulateVerb, RefusesOptionsForSendingThatDoNotFit) {
  SimulateOptions o = options("a.log");
  o.to = "vcan_none";
  EXPECT_THAT(usage_error(o), HasSubstr("--to: sends frames, expected no --out"));
  o.out = "-";
  o.speed = 0.0;
  EXPECT_THAT(usage_error(o), HasSubstr("--speed: 0, expected a factor above 0"));
  o.speed = 2.0;
  o.asap = true;
  EXPECT_THAT(usage_error(o), HasSubstr("--asap: has no speed"));
  o.speed = 1.0;
  o.batch_ticks = 0;
  EXPECT_THAT(usage_error(o), HasSubstr("--batch: 0, expected 1 to 100000"));
  o.batch_ticks = 1;
  EXPECT_THROW(static_cast<void>(simulate(o)), RunError) << "there is no such interface";
  o.to.clear();
  EXPECT_THAT(usage_error(o), HasSubstr("expected --to INTERFACE too"));
}

TEST_F(SimulateVerb, LosesFramesOnRequest) {
  SimulateOptions o = options("a.log");
  o.duration_s = 30.0;
  o.faults = {"loss:fraction=0.1"};
  EXPECT_EQ(simulate(o), 0);
  EXPECT_NEAR(static_cast<double>(std::ranges::count(content(o.out), '\n')), 24300.0, 250.0);
}

TEST_F(SimulateVerb, RefusesWhatItDoesNotUnderstandAndSaysWhatItExpects) {
  SimulateOptions o = options("a.log");
  o.load = "half";
  EXPECT_THAT(usage_error(o), HasSubstr("--load: 'half', expected laden or empty"));
  o = options("a.log");
  o.duration_s = -1.0;
  EXPECT_THAT(usage_error(o), HasSubstr("--duration: -1, expected"));
  o = options("a.log");
  o.effects = {"magic"};
  EXPECT_THAT(usage_error(o), HasSubstr("--effect: unknown effect 'magic', expected one of"));
  o = options("a.log");
  o.standstill_s = {9.0, 3.0};
  EXPECT_THAT(usage_error(o), HasSubstr("--standstill: 9"));
  o.standstill_s = {100.0, 200.0, 250.0, 300.0};
  EXPECT_THAT(usage_error(o), HasSubstr("--standstill: 250, expected a start of 256 or more"));
  o = options("a.csv");
  o.faults = {"loss"};
  EXPECT_THAT(usage_error(o), HasSubstr("expected --format candump"));
  o = options("a.log");
  o.format = "xml";
  EXPECT_THAT(usage_error(o), HasSubstr("--format: 'xml', expected candump or csv"));
  o = options("a.log");
  o.truth = o.out;
  EXPECT_THAT(usage_error(o), HasSubstr("named for two outputs"));
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(SimulateVerb, AsksForADbcWhenASensorHasAnotherRange) {
  SimulateOptions o = options("a.log");
  o.faults = {"clipping:channel=frame,range_mps2=0.3"};
  o.config = (folder_ / "car.toml").string();
  EXPECT_THAT(usage_error(o), HasSubstr("--dbc"));
}

TEST_F(SimulateVerb, ReportsAFullDiskAndAMissingFolder) {
  SimulateOptions o = options("a.log");
  o.out = "/dev/full";
  EXPECT_THROW(static_cast<void>(simulate(o)), RunError);
  o.out = (folder_ / "no" / "such" / "a.log").string();
  EXPECT_THROW(static_cast<void>(simulate(o)), RunError);
}

TEST_F(SimulateVerb, SimulatesEitherTruckOfAWholeCar) {
  SimulateOptions o = options("a.csv");
  o.truth = (folder_ / "truth.csv").string();
  o.force = true;
  std::vector<std::string> records;
  for (const std::string vehicle : {"", "leading", "trailing"}) {
    o.vehicle = vehicle;
    ASSERT_EQ(simulate(o), 0);
    records.push_back(content(o.out));
    EXPECT_EQ(content(o.truth).find("# vehicle = ") != std::string::npos, !vehicle.empty());
  }
  EXPECT_THAT(content(o.truth), HasSubstr("# vehicle = trailing\n# frame_mass_kg = 2200\n"));
  EXPECT_NE(records[0], records[1]);
  EXPECT_NE(records[1], records[2]);
}

TEST_F(SimulateVerb, WritesTheMassThatMovesWithOneTruckOfAWholeCar) {
  SimulateOptions o = options("a.csv");
  o.config = (folder_ / "car.toml").string();
  o.force = true;
  ASSERT_EQ(simulate(o), 0);
  EXPECT_THAT(content(o.config), HasSubstr("moving_mass_kg = 37200.0\n"));
  o.vehicle = "leading";
  ASSERT_EQ(simulate(o), 0);
  EXPECT_THAT(content(o.config), HasSubstr("moving_mass_kg = 31530.9\nsuspension"));
  o.extra_sensors = true;
  ASSERT_EQ(simulate(o), 0);
  EXPECT_THAT(content(o.config), HasSubstr("far_mass_kg = 5669.1\nframe_pitch_mass_kg = 1851.9\n"));
  EXPECT_THAT(content(o.out), testing::StartsWith(std::string{sim::kExtrasHeader}));
  o.vehicle = "";
  EXPECT_THAT(usage_error(o), HasSubstr("--extra-sensors: a truck alone, expected --vehicle"));
}

TEST_F(SimulateVerb, KnowsWhatAWholeCarCannotHave) {
  SimulateOptions o = options("a.csv");
  o.vehicle = "middle";
  EXPECT_THAT(usage_error(o), HasSubstr("--vehicle: 'middle', expected leading or trailing"));
  o.vehicle = "leading";
  o.effects = {"viscous"};
  EXPECT_EQ(usage_error(o), "no error");
  o.effects = {"presliding_hysteresis"};
  EXPECT_THAT(usage_error(o), HasSubstr("--vehicle: an effect with a memory"));
}

}  // namespace
}  // namespace dampline::app

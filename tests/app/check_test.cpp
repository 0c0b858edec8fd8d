// SPDX-License-Identifier: MIT
// `config check`: what it finds beyond the keys, alone and against a record.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ConfigCheck : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(program_
                  .run("simulate --duration 70 --seed 3 --quiet --out run.log --dbc sensors.dbc "
                       "--config-out car.toml")
                  .code,
              0);
  }
  /// The simulator's configuration with one text for another, and a tail.
  void write_changed(const std::string& from, const std::string& to, const std::string& tail = "") {
    std::string text = program_.read("car.toml");
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos);
    program_.write("changed.toml", text.replace(at, from.size(), to) + tail);
  }
  /// The error of the changed configuration, which is refused as a wrong usage.
  std::string refusal(const std::string& more = "") {
    const Program::Outcome outcome = program_.run("config check changed.toml" + more);
    EXPECT_EQ(outcome.code, 2) << outcome.output;
    EXPECT_THAT(outcome.error, HasSubstr("changed.toml"));
    return outcome.error;
  }
  Program program_;
};

TEST_F(ConfigCheck, OpensTheDbcFileAndItsSignals) {
  EXPECT_EQ(program_.run("config check car.toml").code, 0);
  write_changed("sensors.dbc", "absent.dbc");
  EXPECT_THAT(refusal(), HasSubstr("absent.dbc: cannot be read"));
  write_changed("WHEELSET_2.ACCEL_Z", "WHEELSET_2.ACELL_Z");
  EXPECT_THAT(refusal(), AllOf(HasSubstr("wheelset2_accel"), HasSubstr("WHEELSET_2.ACCEL_Z")));
}

TEST_F(ConfigCheck, RefusesOneSignalForTwoChannels) {
  write_changed("WHEELSET_2.ACCEL_Z", "WHEELSET_1.ACCEL_Z");
  EXPECT_THAT(refusal(), AllOf(HasSubstr("wheelset2_accel"), HasSubstr("wheelset1_accel")));
  EXPECT_EQ(program_.run("identify run.log --config changed.toml").code, 2);
  EXPECT_FALSE(program_.exists("run.run"));
}

TEST_F(ConfigCheck, RefusesFactorsAndColumnsBesideFrames) {
  write_changed("[car]", "[car]", "[input.scale]\nframe_accel_mps2 = 9.80665\n");
  EXPECT_THAT(refusal(), HasSubstr("[input.scale] frame_accel_mps2"));
  EXPECT_EQ(program_.run("identify run.log --config changed.toml").code, 2);
  write_changed("[car]", "[car]", "[input.columns]\nframe_accel_mps2 = \"a\"\n");
  EXPECT_THAT(refusal(), HasSubstr("[input.columns] frame_accel_mps2"));
}

TEST_F(ConfigCheck, RefusesTablesThatNothingReads) {
  write_changed("[car]", "[car]", "[run]\nspeed = 3\n");
  EXPECT_THAT(refusal(), HasSubstr("\"run\""));
  write_changed("[car]", "[car]", "[gpio]\nlamp = \"7\"\n");
  EXPECT_THAT(refusal(), HasSubstr("[gpio] chip"));
  program_.write("changed.toml", "[input.can]\nfar_frame_accel = \"FAR_FRAME.ACCEL_Z\"\n");
  EXPECT_THAT(refusal(), HasSubstr("far_mass_kg"));
  program_.write("changed.toml", "# nothing yet\n");
  EXPECT_THAT(refusal(), HasSubstr("found no key"));
}

TEST_F(ConfigCheck, ReadsTheBeginningOfARecord) {
  const auto right = program_.run("config check car.toml --record run.log");
  EXPECT_EQ(right.code, 0) << right.error;
  EXPECT_THAT(right.output, AllOf(HasSubstr("300.000 Hz"), HasSubstr("WHEELSET_2.ACCEL_Z")));
  write_changed("sample_rate_hz = 300", "sample_rate_hz = 290");
  EXPECT_THAT(refusal(" --record run.log"), HasSubstr("sample_rate_hz"));
  EXPECT_EQ(program_.run("config check car.toml --record absent.log").code, 1);
}

TEST_F(ConfigCheck, TellsFramesFromColumns) {
  program_.write("columns.toml", "[input.columns]\nframe_accel_mps2 = \"a\"\n");
  EXPECT_THAT(program_.run("config check columns.toml --record run.log").error,
              HasSubstr("run.log holds frames"));
  ASSERT_EQ(program_.run("simulate --duration 70 --quiet --out run.csv").code, 0);
  EXPECT_THAT(program_.run("config check car.toml --record run.csv").error,
              HasSubstr("run.csv holds columns"));
  program_.write("mass.toml", "[car]\nmoving_mass_kg = 9700.0\n");
  EXPECT_EQ(program_.run("config check mass.toml --record run.csv").code, 0);
}

TEST_F(ConfigCheck, RefusesTheTablesOfATruckBesideARig) {
  std::string rig = "time_s,deflection_m,force_n\n";
  for (int i = 0; i < 3000; ++i)
    rig += fmt::format("{},{},{}\n", i / 300.0, 0.01 * std::sin(0.05 * i),
                       std::cos(0.05 * i) > 0.0 ? 500 : -500);
  program_.write("rig.csv", rig);
  program_.write("changed.toml", "[record]\nvehicle = \"7\"\n[model]\nstiffness = \"none\"\n");
  EXPECT_EQ(program_.run("config check changed.toml --record rig.csv").code, 0);
  for (const std::string table : {"[car]\nmoving_mass_kg = 37200.0", "[guards]\nwait_s = 24.0",
                                  "[input.anti_alias]\norder = 4"}) {
    program_.write("changed.toml", table + "\n");
    EXPECT_THAT(refusal(" --record rig.csv"),
                AllOf(HasSubstr(table.substr(0, table.find('\n'))), HasSubstr("a rig's record")));
  }
}

TEST_F(ConfigCheck, SaysWhichFramesALogHasInstead) {
  const auto found = program_.run("config check car.toml --record /dev/stdin",
                                  "sed 's/31\\([012]\\)#/41\\1#/' run.log |");
  EXPECT_EQ(found.code, 2);
  EXPECT_THAT(found.error, AllOf(HasSubstr("0x410"), HasSubstr("0x412")));
}

}  // namespace
}  // namespace dampline::app

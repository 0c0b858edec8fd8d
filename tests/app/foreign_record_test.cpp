// SPDX-License-Identifier: MIT
// Records as other people's loggers write their headers, and files that are no records.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "app/config/columns.hpp"
#include "drivers/text/kind.hpp"
#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(TruckHeader, TellsFrameAndWheelsetsByTheirWords) {
  EXPECT_EQ(truck_column("Frame acceleration [g]", ""), Column::kFrameAccel);
  EXPECT_EQ(truck_column("Rahmen", "m/s²"), Column::kFrameAccel);
  EXPECT_EQ(truck_column("Axle box 1 (mm/s^2)", ""), Column::kWheelset1Accel);
  EXPECT_EQ(truck_column("Radsatz2 Beschleunigung", ""), Column::kWheelset2Accel);
  EXPECT_EQ(truck_column("Frame velocity [m/s]", ""), std::nullopt);
  EXPECT_EQ(truck_column("Frame acceleration [mm]", ""), std::nullopt);
  EXPECT_EQ(truck_column("Wheelset acceleration [g]", ""), std::nullopt) << "which of the two";
  EXPECT_EQ(truck_column("Wheelset 3 [g]", ""), std::nullopt);
  EXPECT_EQ(truck_column("Frame over wheelset 1 [g]", ""), std::nullopt) << "of both";
  EXPECT_EQ(truck_column("Frame acceleration setpoint [g]", ""), std::nullopt);
}

/// A simulated record under other headers.
class ForeignHeader : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(program_.run("simulate --duration 60 --seed 5 --quiet --out own.csv").code, 0);
    level_n_ = level("own.csv");
    ASSERT_GT(level_n_, 8000.0);
  }
  /// The record with `head` and every number but the time times `factor`.
  void write(const std::string& head, double time_factor, double factor) {
    std::istringstream own{program_.read("own.csv")};
    std::string text = head;
    std::string line;
    std::getline(own, line);
    while (std::getline(own, line)) {
      std::istringstream cells{line};
      std::string cell;
      for (int i = 0; std::getline(cells, cell, ','); ++i)
        text += fmt::format("{}{:.12g}", i == 0 ? "" : ",",
                            std::stod(cell) * (i == 0 ? time_factor : factor));
      text += '\n';
    }
    program_.write("run.csv", text);
  }
  double level(const std::string& arguments) {
    const auto run = program_.run("identify --no-report --force --out r --json " + arguments);
    EXPECT_EQ(run.code, 0) << run.error;
    if (run.code != 0) return 0.0;
    return nlohmann::json::parse(run.output)["parameters"][0]["value"].get<double>();
  }
  Program program_;
  double level_n_{0.0};
  static constexpr double kPerG = 1.0 / 9.80665;
};

TEST_F(ForeignHeader, CountsUnitsWithoutAConfiguration) {
  write("Time [ms],Frame acceleration [g],Wheelset 1 [g],Wheelset 2 [g]\n", 1000.0, kPerG);
  EXPECT_NEAR(level("run.csv"), level_n_, 1e-3);
  write("Zeit,Rahmen,Radsatz 1,Radsatz 2\ns,mm/s²,mm/s²,mm/s²\n", 1.0, 1000.0);
  EXPECT_NEAR(level("run.csv"), level_n_, 1e-3);
}

TEST_F(ForeignHeader, CountsUnitsOfMappedColumns) {
  write("Time [s],A [g],B [g],C [g]\n", 1.0, kPerG);
  program_.write("all.toml",
                 "[input.columns]\nframe_accel_mps2 = \"A [g]\"\nwheelset1_accel_mps2 = \"B [g]\"\n"
                 "wheelset2_accel_mps2 = \"C [g]\"\n");
  EXPECT_NEAR(level("run.csv --config all.toml"), level_n_, 1e-3);
  program_.write("scaled.toml",
                 program_.read("all.toml") + "[input.scale]\nframe_accel_mps2 = 9.80665\n");
  EXPECT_NEAR(level("run.csv --config scaled.toml"), level_n_, 1e-3) << "once, not twice";
}

TEST_F(ForeignHeader, RecognisesTheRestOfAPartlyMappedHeader) {
  write("Time [s],Sensor 7 [g],Axle 1 [g],Axle 2 [g]\n", 1.0, kPerG);
  program_.write("one.toml", "[input.columns]\nframe_accel_mps2 = \"Sensor 7 [g]\"\n");
  EXPECT_NEAR(level("run.csv --config one.toml"), level_n_, 1e-3);
}

TEST_F(ForeignHeader, RefusesAnotherUnitThanAnAcceleration) {
  write("Time [s],A [V],B [V],C [V]\n", 1.0, kPerG);
  program_.write("volt.toml",
                 "[input.columns]\nframe_accel_mps2 = \"A [V]\"\nwheelset1_accel_mps2 = \"B [V]\"\n"
                 "wheelset2_accel_mps2 = \"C [V]\"\n");
  const auto run = program_.run("identify run.csv --config volt.toml");
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.error, AllOf(HasSubstr("\"V\""), HasSubstr("[input.scale]")));
  write("time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\ns,g,g,g\n", 1.0, kPerG);
  EXPECT_THAT(program_.run("identify run.csv").error, HasSubstr("frame_accel_mps2 in g"));
}

TEST(RigHeader, TakesTheColumnWhoseUnitIsOfItsKind) {
  const Program program;
  std::string text = "Time [s],LVDT [V],LVDT [mm],Force [kN]\n";
  for (int i = 0; i < 6000; ++i) {
    const double t = i / 300.0;
    const double x = 0.02 * std::sin(6.283185307 * t);
    text += fmt::format("{:.6f},{:.6f},{:.6f},{:.6f}\n", t, 5.0 * x, 1e3 * x,
                        0.5 * std::tanh(50.0 * std::cos(6.283185307 * t)));
  }
  program.write("rig.csv", text);
  const auto run = program.run("identify rig.csv --no-report --json");
  EXPECT_EQ(run.code, 0) << run.error;
  EXPECT_THAT(run.output, HasSubstr("deflection_m is column \\\"LVDT [mm]\\\" (mm), times 0.001."));
}

TEST(ForeignKind, KnowsNoRecordForAnotherFormat) {
  using drivers::foreign_kind;
  EXPECT_FALSE(foreign_kind("(1600000000.123456) can0 123#11223344\n"));
  EXPECT_FALSE(foreign_kind("time_s,deflection_m,force_n\n0,1,2\n"));
  EXPECT_FALSE(foreign_kind("[12:00:01] can0 123 [2] 11 22\n"));
  EXPECT_FALSE(foreign_kind("% written by MATLAB\n1 2 3\n"));
  EXPECT_FALSE(foreign_kind(""));
  ASSERT_TRUE(foreign_kind("{\n  \"a\": 1}"));
  EXPECT_EQ(foreign_kind(" [1.5, 2]")->name, "JSON");
  EXPECT_EQ(foreign_kind("%PDF-1.7\n")->name, "a PDF document");
}

TEST(ForeignFile, IsNamedShortlyWithTheWayOut) {
  const Program program;
  std::string json = "{\"rows\": [";
  for (int i = 0; i < 20000; ++i) json += fmt::format("{{\"time\": {}, \"force\": 1}}, ", i);
  program.write("rows.json", json + "{}]}");
  program.write("rows.log", json + "{}]}");
  program.write("table.csv", std::string(60000, 'x') + "," + std::string(3000, ',') + "\n1,2\n");
  for (const std::string arguments :
       {"identify rows.json", "identify rows.log", "explain rows.json", "identify - < rows.json"}) {
    const auto run = program.run(arguments);
    EXPECT_EQ(run.code, 1) << arguments;
    EXPECT_LT(run.error.size(), 400U) << arguments;
    EXPECT_THAT(run.error, HasSubstr("JSON")) << arguments;
  }
  const auto wide = program.run("identify table.csv");
  EXPECT_EQ(wide.code, 1);
  EXPECT_LT(wide.error.size(), 1000U);
  EXPECT_THAT(wide.error, AllOf(HasSubstr("xxx..."), HasSubstr("more"), Not(HasSubstr("JSON"))));
}

}  // namespace
}  // namespace dampline::app

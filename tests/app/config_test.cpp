// SPDX-License-Identifier: MIT
#include "app/config/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "app/error.hpp"
#include "app/text/format.hpp"

namespace dampline::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string config_error(const std::string& toml) {
  try {
    static_cast<void>(parse_config(toml, "car.toml"));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Config, TakesEveryKeyOfTheDesign) {
  const Config config = parse_config(R"(
[car]
moving_mass_kg = 9700
wheelbase_m = 1.8
suspension_stiffness_npm = 2.0e6
[input]
sample_rate_hz = 250
speed_mps = 22.2
leading = "wheelset2"
[input.noise_mps2]
wheelset1 = 0.05
[input.can]
dbc = "sensors.dbc"
frame_accel = "TRUCK_FRAME.ACCEL_Z"
wheelset1_accel = "W1.ACCEL_Z"
wheelset2_accel = "W2.ACCEL_Z"
[input.columns]
deflection_m = "x_m"
[input.scale]
force_n = 35.15065188
[input.range_mps2]
frame = 49.0
[model]
base = ["coulomb", "viscous"]
candidates = ["all"]
inertia = "identify"
velocity_corner_hz = "auto"
curve_nodes_mps = [0.001, 0.002, 0.003, 0.004, 0.005, 0.006, 0.007, 0.008]
[estimate]
memory = "window"
window_s = 120
[guards]
wait_s = 12
)",
                                     "car.toml");
  EXPECT_EQ(config.car.moving_mass_kg, 9700.0);
  EXPECT_EQ(config.car.suspension_stiffness_npm, 2.0e6);
  EXPECT_EQ(config.input.sample_rate_hz, 250.0);
  EXPECT_EQ(config.input.can.accel[1], "W1.ACCEL_Z");
  EXPECT_EQ(config.input.header(Column::kDeflection), "x_m");
  EXPECT_EQ(config.input.header(Column::kForce), "force_n");
  EXPECT_EQ(config.input.scale[index(Column::kForce)], 35.15065188);
  EXPECT_EQ(config.input.range_mps2[0], 49.0);
  EXPECT_FALSE(config.input.range_mps2[1].has_value());
  EXPECT_EQ(config.model.base, (std::vector<std::string>{"coulomb", "viscous"}));
  EXPECT_EQ(config.model.inertia, "identify");
  EXPECT_FALSE(config.model.velocity_corner_hz.has_value());
  EXPECT_EQ(config.model.curve_nodes_mps.size(), 8U);
  EXPECT_EQ(config.estimate.memory, "window");
  EXPECT_EQ(config.estimate.window_s, 120.0);
  EXPECT_EQ(config.car.wheelbase_m, 1.8);
  EXPECT_EQ(config.input.speed_mps, 22.2);
  EXPECT_EQ(config.input.leading, "wheelset2");
  EXPECT_EQ(config.input.noise_mps2[1], 0.05);
  EXPECT_FALSE(config.input.noise_mps2[0].has_value());
  EXPECT_EQ(config.guards.wait_s, 12.0);
}

TEST(Config, NamesAnUnknownKeyItsLineAndTheNearestKnownOne) {
  EXPECT_THAT(config_error("[car]\n\nmoving_mass = 1.0\n"),
              AllOf(HasSubstr("car.toml:3:"), HasSubstr("\"moving_mass\""), HasSubstr("[car]"),
                    HasSubstr("moving_mass_kg")));
}

TEST(Config, SaysIntoWhichTableAMisplacedKeyBelongs) {
  EXPECT_THAT(config_error("[car]\nsample_rate_hz = 300.0\n"),
              AllOf(HasSubstr("car.toml:2:"), HasSubstr("belongs into [input]")));
}

TEST(Config, RefusesAnUnknownTable) {
  EXPECT_THAT(config_error("[inptu]\n"),
              AllOf(HasSubstr("car.toml:1:"), HasSubstr("nearest known one is input")));
  EXPECT_THAT(config_error("[input.cann]\n"), HasSubstr("nearest known one is can"));
}

TEST(Config, RefusesAValueOfAWrongType) {
  EXPECT_THAT(config_error("[car]\nmoving_mass_kg = \"heavy\"\n"),
              AllOf(HasSubstr("car.toml:2: [car] moving_mass_kg"), HasSubstr("\"heavy\""),
                    HasSubstr("a number")));
  EXPECT_THAT(config_error("[input.can]\ndbc = 3\n"),
              AllOf(HasSubstr("found 3"), HasSubstr("a text")));
  EXPECT_THAT(config_error("[model]\nbase = \"coulomb\"\n"), HasSubstr("an array"));
  EXPECT_THAT(config_error("[input.anti_alias]\norder = 2.5\n"), HasSubstr("a whole number"));
  EXPECT_THAT(config_error("[input.anti_alias]\nframe_corner_hz = 0\n"), HasSubstr("found 0"));
  EXPECT_THAT(config_error("car = 1\n"), HasSubstr("car.toml:1:"));
  EXPECT_THAT(config_error("[car]\nmoving_mass_kg = true\n"), HasSubstr("found true"));
}

TEST(Config, RefusesAValueOutOfItsRange) {
  EXPECT_THAT(config_error("[car]\nmoving_mass_kg = -1.0\n"),
              AllOf(HasSubstr("-1"), HasSubstr("from 1")));
  EXPECT_THAT(config_error("[car]\nmoving_mass_kg = nan\n"), HasSubstr("found nan"));
  EXPECT_THAT(config_error("[car]\nmoving_mass_kg = inf\n"), HasSubstr("found inf"));
  EXPECT_THAT(config_error("[model]\nvelocity_corner_hz = 0.8\n"), HasSubstr("one of 0.7, 1"));
  EXPECT_THAT(config_error("[model]\nvelocity_corner_hz = \"often\"\n"), HasSubstr("\"auto\""));
  EXPECT_THAT(config_error("[estimate]\nmemory = \"short\"\n"), HasSubstr("\"forgetting\""));
}

TEST(Config, NamesTheNearestEffect) {
  EXPECT_THAT(config_error("[model]\nbase = [\"columb\"]\n"),
              AllOf(HasSubstr("\"columb\""), HasSubstr("\"coulomb\"")));
}

TEST(Config, WantsEightAscendingNodes) {
  EXPECT_THAT(config_error("[model]\ncurve_nodes_mps = [0.001, 0.002]\n"), HasSubstr("expected 8"));
  EXPECT_THAT(
      config_error("[model]\ncurve_nodes_mps = [0.001, 0.002, 0.002, 0.004, 0.005, 0.006, 0.007, "
                   "0.008]\n"),
      HasSubstr("ascending"));
}

TEST(Config, ReportsTheLineOfASyntaxError) {
  EXPECT_THAT(config_error("[car]\nmoving_mass_kg 1.0\n"),
              AllOf(HasSubstr("car.toml:2:"), HasSubstr("not TOML")));
}

TEST(Config, ReportsAFileThatIsNotThere) {
  EXPECT_THROW(static_cast<void>(load_config("no_such_file.toml")), UsageError);
}

TEST(Config, ShownLoadsBackToTheSame) {
  Config config;
  config.car.moving_mass_kg = 0.1 + 9699.9;
  config.car.suspension_stiffness_npm = 1.0 / 3e-7;
  config.input.can.dbc = "a \"quoted\" \\ name\n.dbc";
  config.input.columns[index(Column::kTime)] = "Zeit [s]";
  config.input.range_mps2[2] = 98.1;
  config.model.base = {"coulomb", "viscous"};
  config.model.velocity_corner_hz = 0.7;
  const std::string shown = show_config(config);
  const Config back = parse_config(shown, "shown.toml");
  EXPECT_EQ(show_config(back), shown);
  EXPECT_EQ(back.car.moving_mass_kg, config.car.moving_mass_kg);
  EXPECT_EQ(back.car.suspension_stiffness_npm, config.car.suspension_stiffness_npm);
  EXPECT_EQ(back.input.can.dbc, config.input.can.dbc);
  EXPECT_EQ(back.input.columns, config.input.columns);
  EXPECT_EQ(back.model.velocity_corner_hz, 0.7);
}

TEST(Config, ShowsTheDefaultsAndTheyLoadBack) {
  const std::string shown = show_config(Config{});
  EXPECT_EQ(show_config(parse_config(shown, "defaults.toml")), shown);
  EXPECT_THAT(shown, HasSubstr("moving_mass_kg = 37200.0"));
}

TEST(Config, FindsTheDbcFileBesideTheConfiguration) {
  const auto folder = std::filesystem::path{testing::TempDir()} / "config_beside";
  std::filesystem::create_directories(folder);
  std::ofstream{folder / "car.toml"} << "[input.can]\ndbc = \"car.dbc\"\n";
  EXPECT_EQ(load_config(folder / "car.toml").input.can.dbc, (folder / "car.dbc").string());
}

TEST(EditDistance, CountsInsertionsDeletionsAndReplacements) {
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("same", "same"), 0U);
}

}  // namespace
}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <vector>

#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

/// What a run on bad input may be: an error with a message and no run directory; or a result that
/// is right. Never a crash, never a wrong curve that does not say so.
class BadInput : public testing::Test {
 protected:
  struct Run {
    int code{0};
    std::string error;
    nlohmann::json json;  ///< parameters.json; null where the run failed
  };

  void simulate(const std::string& name, const std::string& more = "") const {
    ASSERT_EQ(program_.run("simulate --duration 60 --quiet --out " + name + " " + more).code, 0);
  }
  Run identify(const std::string& arguments) const {
    const auto outcome = program_.run("identify --no-report --out result --json " + arguments);
    Run run{outcome.code, outcome.error, {}};
    EXPECT_EQ(program_.exists("result/run.toml"), outcome.code == 0);
    if (outcome.code == 0) run.json = nlohmann::json::parse(outcome.output);
    return run;
  }
  void expect_failure(const std::string& arguments,
                      const testing::Matcher<std::string>& message) const {
    const Run run = identify(arguments);
    EXPECT_EQ(run.code, 1);
    EXPECT_THAT(run.error, message);
  }
  /// Within a few per cent, or within three of the stated deviations.
  static void expect_right(const Run& run) {
    ASSERT_EQ(run.code, 0) << run.error;
    const auto& coulomb = run.json.at("parameters").at(0);
    const double error = std::fabs(coulomb.at("value").get<double>() - kLevel_n);
    EXPECT_LT(error, std::max(0.02 * kLevel_n, 3.0 * coulomb.at("std").get<double>()));
  }
  static std::uint64_t count(const Run& run, const std::string& name) {
    return run.json.at("counts").at(name).get<std::uint64_t>();
  }
  static std::uint64_t bridged(const Run& run) {
    return run.json.at("repair").at("values_bridged").get<std::uint64_t>();
  }
  [[nodiscard]] std::vector<std::string> lines(const std::string& name) const {
    std::istringstream stream{program_.read(name)};
    std::vector<std::string> out;
    for (std::string line; std::getline(stream, line);) out.push_back(line);
    return out;
  }
  void write_lines(const std::string& name, const std::vector<std::string>& lines) const {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    program_.write(name, text);
  }

  static constexpr double kLevel_n = 8356.0;
  Program program_;
};

TEST_F(BadInput, EmptyFile) {
  program_.write("a.log", "");
  program_.write("a.csv", "");
  expect_failure("a.log", HasSubstr("a.log: is empty"));
  expect_failure("a.csv", HasSubstr("a.csv: is empty"));
}

TEST_F(BadInput, FileOfTheWrongKind) {
  program_.write("a.log", "time_s,force_n\n1,2\n");
  program_.write("b.csv", "(1600000000.000000) can0 123#00\n");
  program_.write("c.csv", std::string("\x89PNG\r\n\x1a\n\0\0\0", 11));
  program_.write("d.txt", "Dear Sir,\nthe car is fine.\n");
  expect_failure("a.log", AllOf(HasSubstr("a.log"), HasSubstr("candump")));
  expect_failure("b.csv",
                 AllOf(HasSubstr("b.csv"), HasSubstr("no complete sample")));  // by content
  expect_failure("c.csv", HasSubstr("c.csv"));
  expect_failure("d.txt", HasSubstr("d.txt"));
}

TEST_F(BadInput, DbcWithoutTheNamedSignal) {
  simulate("a.log", "--dbc a.dbc");
  program_.write("car.toml",
                 "[input.can]\ndbc = \"a.dbc\"\nframe_accel = \"TRUCK_FRAME.ACEL_Z\"\n");
  const auto outcome = program_.run("identify a.log --config car.toml --out result");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.error, AllOf(HasSubstr("frame_accel"), HasSubstr("TRUCK_FRAME.ACEL_Z"),
                                   HasSubstr("TRUCK_FRAME.ACCEL_Z")));
  EXPECT_FALSE(program_.exists("result"));
}

TEST_F(BadInput, MissingColumn) {
  simulate("a.csv");
  std::string text = program_.read("a.csv");
  text.replace(text.find("wheelset2_accel_mps2"), 20, "wheelset2_temperature");
  program_.write("a.csv", text);
  expect_failure("a.csv",
                 AllOf(HasSubstr("wheelset2_accel_mps2"), HasSubstr("wheelset2_temperature")));
}

TEST_F(BadInput, LogOfAnotherCar) {
  program_.write("a.log", "(1600000000.000000) can0 123#00\n(1600000000.010000) can0 124#0011\n");
  expect_failure("a.log", AllOf(HasSubstr("no complete sample"), HasSubstr("0x310")));
}

TEST_F(BadInput, NotANumberAndInfinite) {
  simulate("a.csv");
  auto rows = lines("a.csv");
  const auto spoil = [&](std::size_t row) {
    rows[row] = rows[row].substr(0, rows[row].find(',')) + ",nan,inf,-inf";
  };
  spoil(3000);
  for (std::size_t row = 6000; row < 6005; ++row) spoil(row);
  write_lines("a.csv", rows);
  const Run run = identify("a.csv");
  expect_right(run);
  EXPECT_TRUE(run.json.at("warnings").empty());
  EXPECT_EQ(bridged(run), 3U);
  EXPECT_EQ(count(run, "not_finite"), 5U);
  EXPECT_GE(count(run, "blocks_excluded"), 1U);
}

TEST_F(BadInput, TimeThatRunsBackwards) {
  simulate("a.csv");
  auto rows = lines("a.csv");
  rows[6000] = "1.0" + rows[6000].substr(rows[6000].find(','));
  write_lines("a.csv", rows);
  expect_failure("a.csv", HasSubstr("a.csv:6001"));
  const Run run = identify("a.csv --skip-bad-lines");
  expect_right(run);
  EXPECT_EQ(count(run, "lines_malformed"), 1U);
  EXPECT_THAT(run.json.at("warnings").dump(), HasSubstr("malformed"));
}

TEST_F(BadInput, LogCutOffInTheMiddleOfALine) {
  simulate("a.log");
  const std::string text = program_.read("a.log");
  program_.write("a.log", text.substr(0, text.size() - 17));
  const Run run = identify("a.log");
  expect_right(run);
  EXPECT_THAT(run.json.at("warnings").dump(), HasSubstr("cut off"));
}

TEST_F(BadInput, TenPerCentOfTheBytesCorrupted) {
  simulate("a.log");
  std::string text = program_.read("a.log").substr(0, 500'000);
  std::mt19937 random{7};
  for (char& c : text)
    if (random() % 10 == 0) c = static_cast<char>(random() % 256);
  program_.write("a.log", text);
  expect_failure("a.log", HasSubstr("a.log:"));
  expect_failure("a.log --skip-bad-lines",
                 AnyOf(HasSubstr("no complete sample"), HasSubstr("nothing could")));
}

TEST_F(BadInput, ChannelStuckForAWhile) {
  simulate("a.log", "--fault stuck:channel=wheelset1,start_s=20,end_s=30");
  const Run run = identify("a.log");
  expect_right(run);
  EXPECT_GT(count(run, "stuck"), 2500U);
}

TEST_F(BadInput, ChannelStuckAllTheTime) {
  simulate("a.log", "--fault stuck:channel=wheelset1,start_s=0,end_s=60");
  expect_failure("a.log", AllOf(HasSubstr("nothing could be identified"), HasSubstr("stuck")));
}

TEST_F(BadInput, ChannelThatClips) {
  simulate("a.log",
           "--fault clipping:channel=wheelset1,range_mps2=2 --dbc a.dbc --config-out a.toml");
  expect_failure("a.log --config a.toml",
                 AllOf(HasSubstr("nothing could"), HasSubstr("full scale")));
}

TEST_F(BadInput, CsvThatClipsWhereNobodyKnows) {
  simulate("a.csv", "--fault soft_clipping:channel=wheelset1,limit_mps2=3");
  const Run run = identify("a.csv");
  EXPECT_THAT(run.json.at("warnings").dump(),
              AllOf(HasSubstr("wheelset1 seems to clip"), HasSubstr("[input.range_mps2]")));
}

TEST_F(BadInput, CsvThatClipsAtTheConfiguredRange) {
  simulate("a.csv", "--fault soft_clipping:channel=wheelset1,limit_mps2=3");
  program_.write("a.toml", "[input.range_mps2]\nwheelset1 = 2.9\n");
  expect_failure("a.csv --config a.toml", HasSubstr("full scale"));
}

TEST_F(BadInput, FivePerCentOfTheFramesLost) {
  simulate("a.log", "--fault loss:fraction=0.05");
  const Run run = identify("a.log");
  expect_right(run);
  EXPECT_NEAR(static_cast<double>(bridged(run)), 0.05 * 3 * 60 * 300, 200.0);
}

TEST_F(BadInput, OneFrameOfThreeLost) {
  simulate("a.log", "--fault loss:fraction=0.33");
  // Hardly two seconds without a longer hole: there is nothing to be had, and the run says why.
  expect_failure("a.log",
                 AllOf(HasSubstr("nothing could be identified"), HasSubstr("samples missing")));
}

TEST_F(BadInput, AFewFramesLost) {
  simulate("a.log", "--fault loss:fraction=0.0002");
  const Run run = identify("a.log");
  expect_right(run);
  EXPECT_GT(bridged(run), 0U);
  EXPECT_EQ(count(run, "lost"), 0U);
  EXPECT_EQ(count(run, "blocks_excluded"), 0U);
}

TEST_F(BadInput, TwoFramesSwapped) {
  simulate("a.log");
  auto frames = lines("a.log");
  std::swap(frames[3000], frames[3001]);
  std::swap(frames[9000], frames[9003]);
  write_lines("a.log", frames);
  expect_right(identify("a.log"));
}

TEST_F(BadInput, WrongNominalRate) {
  simulate("a.csv");
  program_.write("a.toml", "[input]\nsample_rate_hz = 310.0\n");
  expect_failure("a.csv --config a.toml", AllOf(HasSubstr("300.000 Hz"), HasSubstr("310.000")));
}

}  // namespace
}  // namespace dampline::app

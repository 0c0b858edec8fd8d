// SPDX-License-Identifier: MIT
// The verbs `inspect` and `motion`, pipes that end early, as a person runs them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "app/motion/series.hpp"
#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Inspect : public testing::Test {
 protected:
  void simulate(const std::string& more) const {
    ASSERT_EQ(program_.run("simulate --duration 70 --seed 4 --quiet --force " + more).code, 0);
  }
  [[nodiscard]] nlohmann::json inspect(const std::string& arguments,
                                       const std::string& before = "") const {
    const auto run = program_.run("inspect --json " + arguments, before);
    EXPECT_EQ(run.code, 0) << run.error;
    return nlohmann::json::parse(run.output);
  }
  /// What it proposes passes the check against the record that it was made of.
  void expect_proposal_fits(const nlohmann::json& found, const std::string& record) const {
    const auto text = found["configuration"].get<std::string>();
    ASSERT_FALSE(text.empty());
    program_.write("car.toml", text);
    const auto check = program_.run("config check car.toml --record " + record);
    EXPECT_EQ(check.code, 0) << check.error << text;
  }
  Program program_;
};

TEST_F(Inspect, DecodesALogAndProposesAConfigurationThatFits) {
  simulate("--out run.log --dbc sensors.dbc");
  const nlohmann::json found = inspect("run.log --dbc sensors.dbc");
  EXPECT_EQ(found["format"], "a candump log");
  EXPECT_EQ(found["start_utc"].get<std::string>().substr(0, 19), "2023-11-14T22:13:20");
  EXPECT_EQ(found["count"], 63000);
  EXPECT_EQ(found["gaps"], 0);
  ASSERT_EQ(found["identifiers"].size(), 3U);
  for (const auto& each : found["identifiers"]) {
    EXPECT_NEAR(each["rate_hz"].get<double>(), 300.0, 0.01);
    EXPECT_EQ(each["frames"], 21000);
  }
  EXPECT_EQ(found["truck"]["frame"]["signal"], "TRUCK_FRAME.ACCEL_Z");
  EXPECT_EQ(found["truck"]["wheelset2"]["signal"], "WHEELSET_2.ACCEL_Z");
  expect_proposal_fits(found, "run.log");
  const auto text = program_.run("inspect run.log --dbc sensors.dbc");
  EXPECT_THAT(text.output, AllOf(HasSubstr("0x310"), HasSubstr("config check car.toml")));
}

TEST_F(Inspect, TellsTheFrameByItsRmsWhereNamesTellNothing) {
  simulate("--out run.log --dbc sensors.dbc");
  ASSERT_EQ(
      std::system(("sed -i 's/TRUCK_FRAME/MSG_A/; s/WHEELSET_1/MSG_B/; s/WHEELSET_2/MSG_C/' '" +
                   program_.path("sensors.dbc").string() + "'")
                      .c_str()),  // NOLINT(cert-env33-c) a test of the program
      0);
  const nlohmann::json found = inspect("run.log --dbc sensors.dbc");
  EXPECT_EQ(found["truck"]["frame"]["signal"], "MSG_A.ACCEL_Z");
  EXPECT_THAT(found["truck"]["frame"]["why"].get<std::string>(), HasSubstr("rms"));
  expect_proposal_fits(found, "run.log");
}

TEST_F(Inspect, ReadsTablesWithForeignHeaders) {
  simulate("--out run.csv");
  std::string text = program_.read("run.csv");
  program_.write("run.csv", "Time [s],Frame [mm/s2],Axle 1 [m/s2],Axle 2 [m/s2],note\n");
  std::istringstream lines{text.substr(text.find('\n') + 1)};
  std::string table = program_.read("run.csv");
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(',');
    const std::size_t second = line.find(',', first + 1);
    table += fmt::format("{},{:.9g}{},1\n", line.substr(0, first),
                         1000.0 * std::stod(line.substr(first + 1, second - first - 1)),
                         line.substr(second));
  }
  program_.write("run.csv", table);
  const nlohmann::json found = inspect("run.csv");
  EXPECT_EQ(found["holds"], "rows");
  EXPECT_NEAR(found["rate_hz"].get<double>(), 300.0, 0.01);
  EXPECT_GT(found["columns"][1]["rms"].get<double>(), 50.0) << "in the column's own unit";
  EXPECT_EQ(found["truck"]["frame"]["signal"], "Frame [mm/s2]");
  expect_proposal_fits(found, "run.csv");
  program_.write("other.csv", "a,b,c\n1,2,3\n2,3,4\n3,5,6\n");
  const nlohmann::json other = inspect("other.csv");
  EXPECT_EQ(other["columns"].size(), 3U);
  EXPECT_EQ(other["configuration"], "");
  EXPECT_FALSE(other["notes"].empty());
}

TEST_F(Inspect, CountsGaps) {
  simulate("--out run.log");
  // 2 s of all frames are missing.
  const nlohmann::json found = inspect(
      "- < cut.log", "awk -F'[(.]' '$2 < 1700000030 || $2 > 1700000031' run.log > cut.log;");
  EXPECT_EQ(found["gaps"], 1);
  EXPECT_NEAR(found["longest_gap_s"].get<double>(), 2.0, 0.01);
}

TEST_F(Inspect, NamesTheWayOutOfWhatItCannotRead) {
  program_.write("a.json", "{\"a\": 1}");
  program_.write("a.parquet", std::string{"PAR1"} + std::string(100, '\0'));
  for (const std::string file : {"a.json", "a.parquet"}) {
    const auto run = program_.run("inspect " + file);
    EXPECT_EQ(run.code, 1);
    EXPECT_THAT(run.error, HasSubstr("CSV"));
  }
  simulate("--out run.csv");
  EXPECT_EQ(program_.run("inspect run.csv --dbc x.dbc").code, 2);
}

/// The rows of a table without its comments and header.
std::vector<std::string> rows_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream lines{text};
  for (std::string line; std::getline(lines, line);)
    if (!line.empty() && (std::isdigit(line[0]) != 0 || line[0] == '-')) out.push_back(line);
  return out;
}

std::string rounded(const std::string& row) {
  double t = 0.0;
  double y = 0.0;
  double v = 0.0;
  EXPECT_EQ(std::sscanf(row.c_str(), "%lf,%lf,%lf", &t, &y, &v), 3);  // NOLINT(cert-err34-c)
  return fmt::format("{:.9g},{:.6g},{:.6g}", t, y, v);
}

TEST_F(Inspect, MotionHasTheRowsOfTheRunDirectory) {
  simulate("--out run.log --dbc sensors.dbc --config-out car.toml");
  ASSERT_EQ(program_.run("identify run.log --config car.toml --no-report --out run").code, 0);
  const auto motion = program_.run("motion run.log --config car.toml --out m.csv --json");
  ASSERT_EQ(motion.code, 0) << motion.error;
  const std::vector<std::string> excerpt = rows_of(program_.read("run/motion.csv"));
  std::vector<std::string> whole;
  for (const std::string& row : rows_of(program_.read("m.csv"))) whole.push_back(rounded(row));
  ASSERT_EQ(excerpt.size(), 6000U);
  ASSERT_GT(whole.size(), 18000U);
  const auto found = std::search(whole.begin(), whole.end(), excerpt.begin(), excerpt.end());
  EXPECT_NE(found, whole.end());
  const auto summary = nlohmann::json::parse(motion.output);
  EXPECT_EQ(summary["rows"], whole.size());
  EXPECT_GT(summary["latency_s"].get<double>(), 24.0);
}

TEST_F(Inspect, MotionInNumPysFormatHasTheSameBits) {
  simulate("--out run.csv");
  ASSERT_EQ(program_.run("motion run.csv --out m.csv").code, 0);
  ASSERT_EQ(program_.run("motion run.csv --out m.npy").code, 0);
  EXPECT_EQ(program_.run("motion run.csv --out m.npy").code, 2) << "--force replaces it";
  EXPECT_EQ(program_.run("motion run.csv --out m.xyz").code, 2);
  const std::vector<std::string> rows = rows_of(program_.read("m.csv"));
  const std::string npy = program_.read("m.npy");
  ASSERT_EQ(npy.substr(0, 6), "\x93NUMPY");
  const std::size_t head =
      10 + static_cast<unsigned char>(npy[8]) + 256U * static_cast<unsigned char>(npy[9]);
  ASSERT_EQ(head % 64, 0U);
  ASSERT_EQ(npy.size(), head + rows.size() * 24);
  for (const std::size_t i : {std::size_t{0}, rows.size() / 2, rows.size() - 1}) {
    std::array<double, 3> row{};
    std::memcpy(row.data(), npy.data() + head + 24 * i, sizeof row);
    EXPECT_EQ(fmt::format("{},{},{}", row[0], row[1], row[2]), rows[i]);
  }
}

/// deflection_m and velocity_mps by row.
std::vector<std::array<double, 2>> motion_of(const std::string& text) {
  std::vector<std::array<double, 2>> out;
  for (const std::string& row : rows_of(text)) {
    const char* at = row.c_str() + row.find(',') + 1;
    char* next = nullptr;
    const double deflection = std::strtod(at, &next);
    out.push_back({deflection, std::strtod(next + 1, nullptr)});
  }
  return out;
}

TEST_F(Inspect, MotionStatesTheNoiseThatItHas) {
  // The same car and the same noise, five times as large: what differs is 0.08 m/s^2 of it.
  program_.write("car.toml", "[model]\nvelocity_corner_hz = 0.7\n");
  std::vector<std::vector<std::array<double, 2>>> runs;
  for (const std::string noise : {"0.02", "0.1"}) {
    simulate("--bias-mps2 0 --drift-mps2 0 --noise-mps2 " + noise + " --out run.csv");
    ASSERT_EQ(program_.run("motion run.csv --config car.toml --force --out m.csv").code, 0);
    runs.push_back(motion_of(program_.read("m.csv")));
  }
  ASSERT_EQ(runs[0].size(), runs[1].size());
  ASSERT_GT(runs[0].size(), 10000U);
  std::array<double, 2> squares{};
  for (std::size_t i = 0; i < runs[0].size(); ++i)
    for (std::size_t k = 0; k < 2; ++k)
      squares[k] +=
          std::pow(runs[1][i][k] - runs[0][i][k], 2) / static_cast<double>(runs[0].size());
  const MotionNoise stated = motion_noise(0.08, 300.0, 0.7, 0.7);
  EXPECT_NEAR(std::sqrt(squares[0]), stated.deflection_m, 0.15 * stated.deflection_m);
  EXPECT_NEAR(std::sqrt(squares[1]), stated.velocity_mps, 0.05 * stated.velocity_mps);
}

TEST(InspectNumbered, ProposesColumnsByNumber) {
  const Program program;
  ASSERT_EQ(program.run("simulate --duration 40 --quiet --out a.csv").code, 0);
  const std::string table = program.read("a.csv");
  const std::size_t first = table.find('\n', table.find("time_s")) + 1;
  program.write("bare.csv", table.substr(first));
  const auto found = program.run("inspect bare.csv");
  ASSERT_EQ(found.code, 0) << found.error;
  const std::size_t begin = found.output.find("[car]");
  ASSERT_NE(begin, std::string::npos) << found.output;
  program.write("bare.toml", found.output.substr(begin));
  EXPECT_EQ(program.run("config check bare.toml --record bare.csv").code, 0);
  ASSERT_EQ(program.run("identify bare.csv --config bare.toml --no-report --out b --quiet").code,
            0);
  ASSERT_EQ(program.run("identify a.csv --no-report --out a --quiet").code, 0);
  EXPECT_EQ(program.read("a/curve.csv"), program.read("b/curve.csv"));
}

TEST(InspectInterface, IsToldApartFromWhatIsNoCanInterface) {
  const Program program;
  EXPECT_THAT(program.run("inspect can77").error, testing::HasSubstr("no such CAN interface"));
  const auto loopback = program.run("inspect lo --duration 1");
  EXPECT_EQ(loopback.code, 1);
  EXPECT_THAT(loopback.error, testing::HasSubstr("lo: "));
}

TEST(MotionNoise, FallsAsTheCornerRises) {
  // One integral of white noise above a sharp corner: S / (4 pi^2 f) of variance, S = 6 s^2 /
  // (fs/2).
  const MotionNoise noise = motion_noise(0.02, 300.0, 0.7, 0.7);
  const double sharp = std::sqrt(6.0 * 0.02 * 0.02 / 150.0 / (39.478 * 0.7));
  EXPECT_NEAR(noise.velocity_mps, sharp, 0.1 * sharp);
  EXPECT_LT(motion_noise(0.02, 300.0, 1.0, 0.7).deflection_m, noise.deflection_m);
  EXPECT_NEAR(motion_noise(0.04, 300.0, 0.7, 0.7).deflection_m, 2.0 * noise.deflection_m, 1e-12);
}

TEST(Pipe, EndsWithACompleteRunAtASignal) {
  const Program program;
  ASSERT_EQ(program.run("simulate --duration 60 --quiet --out run.log").code, 0);
  // The writer stays open: only the signal can end the run.
  const auto run = program.run(
      "identify - --no-report --out run < fifo & pid=$!; exec 3> fifo; cat run.log >&3; sleep 2; "
      "kill -INT $pid; wait $pid",
      "mkfifo fifo; env");
  EXPECT_EQ(run.code, 0) << run.error;
  EXPECT_TRUE(program.exists("run/run.toml"));
  EXPECT_TRUE(program.exists("run/state.dls"));
  ASSERT_EQ(program.run("identify run.log --no-report --out whole").code, 0);
  EXPECT_EQ(program.read("run/state.dls"), program.read("whole/state.dls"));
}

TEST(Pipe, EndsQuietlyWhenItsReaderGoes) {
  const Program program;
  for (const std::string command : {"simulate --duration 60 --quiet", "config show"}) {
    const auto run = program.run(command + " | head -n 1 >/dev/null; true");
    EXPECT_EQ(run.error, "") << command;
  }
}

}  // namespace
}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include "tests/app/program.hpp"

#include <gmock/gmock.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "app/config/config.hpp"
#include "app/run/state.hpp"

namespace dampline::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kLevel_n = 8356.0;

class Identify : public testing::Test {
 protected:
  void simulate(const std::string& name, const std::string& more = "") const {
    ASSERT_EQ(program_.run("simulate --duration 60 --quiet --out " + name + " " + more).code, 0);
  }
  Program program_;
};

double coulomb_of(const std::string& json) {
  return nlohmann::json::parse(json).at("parameters").at(0).at("value").get<double>();
}

TEST_F(Identify, WritesARunDirectoryFromACandumpLog) {
  simulate("run.log");
  const auto outcome = program_.run("identify run.log --out result");
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("coulomb"), HasSubstr("N/m"), HasSubstr("result/report.html")));
  EXPECT_THAT(outcome.error, IsEmpty());
  EXPECT_NEAR(coulomb_of(program_.read("result/parameters.json")), kLevel_n, 0.03 * kLevel_n);
  EXPECT_THAT(program_.read("result/curve.csv"),
              testing::StartsWith("velocity_mps,force_n,std_n,samples\n-"));
  EXPECT_THAT(program_.read("result/report.html"), HasSubstr("</html>"));
  EXPECT_NO_THROW(static_cast<void>(load_config(program_.path("result/run.toml"))));
  const auto statistics = std::make_unique<Statistics>();
  EXPECT_NO_THROW(load_state(program_.path("result/state.dls"), *statistics));
  EXPECT_GT(statistics->header.counts.blocks, 20U);
}

TEST_F(Identify, FindsTheSameInTheCsvOfTheSameRun) {
  simulate("run.log");
  simulate("run.csv");
  const double log = coulomb_of(program_.run("identify run.log --out a --json --no-report").output);
  const double csv = coulomb_of(program_.run("identify run.csv --out b --json --no-report").output);
  EXPECT_NEAR(log, csv, 1e-3 * log);
}

TEST_F(Identify, ReadsCandumpTextFromAPipe) {
  simulate("run.log");
  const auto piped = program_.run("identify - --out a --json --no-report", "cat run.log |");
  EXPECT_EQ(piped.code, 0) << piped.error;
  const auto file = program_.run("identify run.log --out b --json --no-report");
  auto of_pipe = nlohmann::json::parse(piped.output);
  auto of_file = nlohmann::json::parse(file.output);
  for (const char* key : {"source", "sha256"}) {
    of_pipe.erase(key);
    of_file.erase(key);
  }
  EXPECT_EQ(of_pipe.dump(), of_file.dump());
}

TEST_F(Identify, PrintsNothingButJsonWhenAskedForJson) {
  simulate("run.csv");
  const auto outcome = program_.run("identify run.csv --out a --json --no-report");
  EXPECT_EQ(outcome.output, program_.read("a/parameters.json"));
  EXPECT_THAT(outcome.error, IsEmpty());
  EXPECT_THAT(program_.run("identify run.csv --out b --quiet --no-report").output, IsEmpty());
}

TEST_F(Identify, NeverOverwritesUnasked) {
  simulate("run.csv");
  EXPECT_EQ(program_.run("identify run.csv --no-report").code, 0);
  EXPECT_EQ(program_.run("identify run.csv --no-report").code, 0);
  EXPECT_TRUE(program_.exists("run.run/run.toml"));
  EXPECT_TRUE(program_.exists("run.run.2/run.toml"));
  EXPECT_EQ(program_.run("identify run.csv --no-report --out run.run").code, 2);
  EXPECT_EQ(program_.run("identify run.csv --no-report --out run.run --force").code, 0);
}

TEST_F(Identify, RepeatsARunFromItsRunToml) {
  simulate("run.csv");
  program_.write("car.toml", "[car]\nmoving_mass_kg = 18600.0\n");
  const auto first = program_.run("identify run.csv --config car.toml --out a --json --no-report");
  const auto again =
      program_.run("identify run.csv --config a/run.toml --out b --json --no-report");
  EXPECT_NEAR(coulomb_of(first.output), 0.5 * kLevel_n, 0.02 * kLevel_n)
      << "forces scale with the mass";
  EXPECT_EQ(first.output, again.output);
}

TEST_F(Identify, LeavesNothingWhereTheDiskFills) {
  simulate("run.csv");
  // A limit on the size of any one file stands for a disk that fills: both fail in write().
  const auto outcome = program_.run("identify run.csv --out a --no-report", "ulimit -f 64;");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.error, AllOf(HasSubstr("cannot write"), HasSubstr("a/")));
  EXPECT_FALSE(program_.exists("a"));
}

TEST_F(Identify, ReportsAnOutputThatCannotBeWritten) {
  simulate("run.csv");
  program_.write("file", "");
  EXPECT_EQ(program_.run("identify run.csv --out file/below --no-report").code, 1);
  EXPECT_EQ(program_.run("identify run.csv --out file --no-report").code, 2);
  const auto full = program_.run("config show > /dev/full 2> /dev/null; exit $?; :");
  EXPECT_EQ(full.code, 1) << "standard output on a full disk";
}

TEST(Report, RebuildsThePageFromTheRunAlone) {
  const Program program;
  ASSERT_EQ(program.run("simulate --duration 60 --quiet --out run.csv").code, 0);
  ASSERT_EQ(program.run("identify run.csv --out a --quiet").code, 0);
  const std::string page = program.read("a/report.html");
  std::filesystem::remove(program.path("run.csv"));
  std::filesystem::remove(program.path("a/report.html"));
  EXPECT_EQ(program.run("report a").code, 0);
  EXPECT_EQ(program.read("a/report.html").substr(0, 2000), page.substr(0, 2000));
  EXPECT_EQ(program.run("report nowhere").code, 1);
  program.write("a/parameters.json", "{}");
  const auto damaged = program.run("report a");
  EXPECT_EQ(damaged.code, 1);
  EXPECT_THAT(damaged.error, HasSubstr("parameters.json"));
}

TEST(ConfigVerb, ChecksAndCompletes) {
  const Program program;
  program.write("good.toml", "[car]\nmoving_mass_kg = 9700.0\n");
  program.write("bad.toml", "[car]\nmoving_mas_kg = 9700.0\n");
  EXPECT_EQ(program.run("config check good.toml").code, 0);
  const auto bad = program.run("config check bad.toml");
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.error, AllOf(HasSubstr("bad.toml:2"), HasSubstr("moving_mass_kg")));
  program.write("whole.toml", program.run("config show good.toml").output);
  EXPECT_EQ(program.run("config show whole.toml").output, program.read("whole.toml"));
  EXPECT_EQ(program.run("config check missing.toml").code, 2);
}

TEST(CommandLine, TellsWrongUsageFromAFailedRun) {
  const Program program;
  EXPECT_EQ(program.run("").code, 2);
  EXPECT_EQ(program.run("identify").code, 2);
  EXPECT_EQ(program.run("identify --colour run.log").code, 2);
  EXPECT_EQ(program.run("identfy run.log").code, 2);
  EXPECT_EQ(program.run("--help").code, 0);
  EXPECT_THAT(program.run("--version").output, HasSubstr("dampline 0."));
  const auto absent = program.run("identify nowhere.log");
  EXPECT_EQ(absent.code, 1);
  EXPECT_THAT(absent.error, HasSubstr("nowhere.log: no such file"));
}

}  // namespace
}  // namespace dampline::app

// SPDX-License-Identifier: MIT
// `dampline compare`, as a person runs it.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/run_files/run_test.hpp"

namespace dampline::app {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class Compare : public RunFilesTest {
 protected:
  /// A simulated run of its own seed; `car` is the configuration.
  void make_run(const std::string& name, const std::string& simulation,
                const std::string& car = "[record]\nvehicle = \"V\"\n") const {
    simulate(name + ".log", simulation);
    program_.write(name + ".toml", car);
    expect_success("identify " + name + ".log --config " + name +
                   ".toml --quiet --no-report --out " + name);
  }
  void expect_refused(const std::string& runs, const std::string& why) const {
    const auto outcome = program_.run("compare " + runs + " --out page");
    EXPECT_EQ(outcome.code, 1) << runs;
    EXPECT_THAT(outcome.error, HasSubstr(why));
    EXPECT_THAT(outcome.output, IsEmpty());
    EXPECT_FALSE(program_.exists("page"));
  }
  static json parameter_of(const json& run, const std::string& name) {
    for (const json& p : run.at("parameters"))
      if (p.at("name") == name) return p;
    return {};
  }
};

TEST_F(Compare, StatesDifferencesInTheirDeviations) {
  make_run("a", "--seed 1");
  make_run("b", "--seed 2");
  make_run("c", "--seed 3 --friction-scale 0.8");
  const auto text = program_.run("compare a b c");
  EXPECT_EQ(text.code, 0) << text.error;
  EXPECT_THAT(text.output,
              AllOf(HasSubstr("2023-11-14 22:13:20"), HasSubstr("linear spring, coulomb"),
                    HasSubstr("trusted"), HasSubstr("Difference to a")));
  const json found = json::parse(program_.run("compare a b c --json").output);
  ASSERT_EQ(found.at("runs").size(), 3U);
  ASSERT_EQ(found.at("differences").size(), 2U);
  for (const json& apart : found.at("differences")) {
    const json first = json::parse(program_.read("a/parameters.json"));
    const json other =
        json::parse(program_.read(apart.at("run").get<std::string>() + "/parameters.json"));
    for (const json& d : apart.at("parameters")) {
      const json p = parameter_of(first, d.at("name"));
      const json q = parameter_of(other, d.at("name"));
      const double value = q.at("value").get<double>() - p.at("value").get<double>();
      const double std = std::hypot(q.at("std").get<double>(), p.at("std").get<double>());
      EXPECT_DOUBLE_EQ(d.at("difference"), value);
      EXPECT_DOUBLE_EQ(d.at("deviations"), value / std);
      EXPECT_DOUBLE_EQ(d.at("percent"), 100.0 * value / p.at("value").get<double>());
      EXPECT_EQ(d.at("unit"), p.at("unit"));
    }
  }
  const auto deviations = [&](std::size_t i) {
    return parameter_of(found.at("differences").at(i), "coulomb").at("deviations").get<double>();
  };
  EXPECT_LT(std::abs(deviations(0)), 4.0) << "the same car";
  EXPECT_LT(deviations(1), -20.0) << "a fifth less friction";
  if (!has_module("jsonschema")) GTEST_SKIP() << "no python3-jsonschema";
  expect_success("compare a b c --out page");
  EXPECT_EQ(shell("/usr/bin/python3 -W ignore -m jsonschema -i page/comparison.json "
                  "'" DAMPLINE_SOURCE_DIR "/app/run/schema/dampline.schema.json'")
                .code,
            0);
}

TEST_F(Compare, DrawsLevelAndStiffnessOverTheDate) {
  make_run("a", "--seed 1", "[record]\nvehicle = \"<V>\"\ntruck = \"A\"\n");
  // Two days later.
  simulate("raw.log", "--seed 2");
  ASSERT_EQ(shell("awk '{split(substr($1, 2), t, \".\"); sub(/^[(][0-9]+/, \"(\" (t[1] + 172800)); "
                  "print}' raw.log > later.log")
                .code,
            0);
  expect_success("identify later.log --config a.toml --quiet --no-report --out b");
  const auto outcome = program_.run("compare a b --out page --json");
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_EQ(outcome.output, program_.read("page/comparison.json"));
  const std::string page = program_.read("page/compare.html");
  EXPECT_THAT(page,
              AllOf(HasSubstr("days since 2023-11-14, 0 h UTC"), HasSubstr("Friction level (kN)"),
                    HasSubstr("Stiffness (MN/m)"), HasSubstr("&lt;V&gt;, A"),
                    HasSubstr("2023-11-16 22:13:20"), Not(HasSubstr("<V>"))));
  EXPECT_EQ(shell("grep -c '<svg' page/compare.html").output, "2\n");
  EXPECT_EQ(program_.run("compare a b --out page").code, 2) << "nothing is replaced unasked";
  EXPECT_EQ(program_.run("compare a b --out page --force").code, 0);
}

TEST_F(Compare, SaysWhereTheRecordIsTheSame) {
  make_run("a", "--seed 1");
  expect_success("identify a.log --quiet --no-report --out again");
  const auto outcome = program_.run("compare a again");
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("of the same record as a"), HasSubstr("+0.0 std")));
}

TEST_F(Compare, RefusesAnotherMassOrBasis) {
  make_run("a", "--seed 1");
  make_run("mass", "--seed 2", "[car]\nmoving_mass_kg = 37201.0\n");
  make_run("rate", "--seed 2", "[input]\nsample_rate_hz = 300.5\n");
  make_run("corner", "--seed 2", "[model]\nvelocity_corner_hz = 1.0\n");
  make_run("filter", "--seed 2", "[input.anti_alias]\ncorner_hz = 90.0\n");
  make_run("nodes", "--seed 2",
           "[model]\ncurve_nodes_mps = [0.003, 0.005, 0.008, 0.011, 0.014, 0.019, 0.026, 0.04]\n");
  expect_refused("a mass",
                 "mass: cannot be compared with a: another mass: [car] moving_mass_kg is "
                 "37201, expected 37200");
  expect_refused("a rate", "another basis: its nominal sample rate is 300.5 Hz, expected 300 Hz");
  expect_refused("a corner", "another basis: its velocity's drift filter has its corner at 1 Hz");
  expect_refused("a filter", "another basis: its anti-aliasing filter");
  expect_refused("a nodes", "another basis: its curve has other nodes");
}

TEST_F(Compare, RefusesARigBesideATruck) {
  make_run("truck", "--seed 1");
  write_rig("one.csv");
  write_rig("two.csv", 1300.0);
  expect_success("identify one.csv --quiet --no-report --out one");
  expect_success("identify two.csv --quiet --no-report --out two");
  expect_success(
      "identify one.csv --method wavelet --terms 'sign(v)' --quiet --no-report --out rows");
  expect_refused("truck one",
                 "one: cannot be compared with truck: is a rig's run, expected a truck's");
  expect_refused("one truck", "is a truck's run, expected a rig's");
  expect_refused("one rows", "is a rig's (--method wavelet) run, expected a rig's");
  const json found = json::parse(program_.run("compare one two --json").output);
  EXPECT_NEAR(found.at("differences").at(0).at("parameters").at(0).at("difference"), 100.0, 5.0);
  EXPECT_THAT(program_.run("compare one two --out page").output,
              Not(HasSubstr("vehicle  truck  start (UTC)  2023")));
  EXPECT_THAT(program_.read("page/compare.html"), HasSubstr("run, in the order given"));
}

TEST_F(Compare, NamesWhatIsNoRun) {
  make_run("a", "--seed 1");
  EXPECT_EQ(program_.run("compare a").code, 2);
  const auto outcome = program_.run("compare a nowhere");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.error, HasSubstr("nowhere"));
  std::filesystem::copy(program_.path("a"), program_.path("b"));
  std::filesystem::remove(program_.path("b/state.dls"));
  EXPECT_THAT(program_.run("compare a b").error, HasSubstr("b/state.dls: cannot be read"));
}

}  // namespace
}  // namespace dampline::app

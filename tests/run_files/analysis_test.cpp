// SPDX-License-Identifier: MIT
// dampline.py and loadrun.m read what the program wrote, by Debian's NumPy, pandas and Octave.
#include <gmock/gmock.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "tests/run_files/run_test.hpp"

namespace dampline::app {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Analysis : public RunFilesTest {
 protected:
  void SetUp() override {
    if (!has_module("numpy")) GTEST_SKIP() << "no python3-numpy";
  }
};

/// Level and stiffness of state.dls as parameters.json has them: other code, from the document.
constexpr const char* kCompareState = R"(
import dampline, json
run = dampline.load("RUN")
names = VISCOUS
level = run.state.level(MASS, run.about["sample_rate"]["value"], viscous="viscous" in names)
assert sorted(level) == sorted(names), level
worst = 0.0
for name in names:
    a, b = level[name], run[name]
    assert a.unit == b.unit
    worst = max(worst, abs(a.value / b.value - 1), abs(a.std / b.std - 1))
print("worst", worst)
assert worst < 1e-9, worst
assert run.state.counts["blocks"] == run.about["counts"]["blocks"]
assert run.state.counts["rows"] == run.about["counts"]["rows"]
assert run.state.total.blocks == sum(e.blocks for e in run.state.entries)
)";

std::string compare_state(const std::string& run, const std::string& mass, bool viscous) {
  std::string code = kCompareState;
  const auto put = [&](const std::string& mark, const std::string& text) {
    code.replace(code.find(mark), mark.size(), text);
  };
  put("RUN", run);
  put("MASS", mass);
  put("VISCOUS", viscous ? "['coulomb', 'stiffness', 'viscous', 'law_width']"
                         : "['coulomb', 'stiffness', 'law_width']");
  return code;
}

TEST_F(Analysis, ReadStateGivesTheProgramsLevelAndStiffness) {
  simulate("laden.log");
  simulate("empty.log", "--load empty --seed 3 --fault loss:fraction=0.0001");
  simulate("rate.csv", "--seed 5");
  program_.write("viscous.toml",
                 "[car]\nmoving_mass_kg = 18600.0\n[model]\nbase = [\"coulomb\", \"viscous\"]\n");
  program_.write("rate.toml", "[input]\nsample_rate_hz = 301.0\n");
  expect_success("identify laden.log --quiet --no-report --out a");
  expect_success("identify empty.log --quiet --no-report --out b --config viscous.toml");
  expect_success("identify rate.csv --quiet --no-report --out c --config rate.toml");
  for (const auto& code :
       {compare_state("a", "37200.0", false), compare_state("b", "18600.0", true),
        compare_state("c", "37200.0", false)}) {
    const auto outcome = python(code);
    EXPECT_EQ(outcome.code, 0) << outcome.output << outcome.error;
  }
}

TEST_F(Analysis, ReadStateRefusesWhatIsDamaged) {
  simulate("run.log");
  expect_success("identify run.log --quiet --no-report --out a");
  const std::string state = program_.read("a/state.dls");
  const std::string read = "import dampline\ndampline.read_state('bad.dls')\n";
  const auto expect_refused = [&](const std::string& bytes, const std::string& why) {
    program_.write("bad.dls", bytes);
    const auto outcome = python(read);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.error, HasSubstr("ValueError: bad.dls: " + why));
  };
  std::string changed = state;
  changed[5000] = static_cast<char>(changed[5000] ^ 1);
  expect_refused(changed, "is damaged");
  expect_refused(state.substr(0, state.size() - 1), "is cut off");
  expect_refused(state.substr(0, 30), "is cut off after 30 bytes");
  expect_refused("", "is no dampline state");
  expect_refused("RIFFxxxx", "is no dampline state");
  changed = state;
  changed[8] = 4;
  expect_refused(changed, "is of version 4");
}

TEST_F(Analysis, LoadGivesParametersAndTables) {
  simulate("run.log");
  program_.write("car.toml", "[record]\nvehicle = \"V\"\n");
  expect_success("identify run.log --config car.toml --quiet --no-report --out a");
  const auto outcome = python(R"(
import dampline, json
run = dampline.load("a")
first = json.load(open("a/parameters.json"))["parameters"][0]
assert (run["coulomb"].value, run["coulomb"].std, run["coulomb"].unit) == (first["value"], first["std"], "N")
assert str(run.start) == "2023-11-14T22:13:20.000190", run.start
assert run.about["vehicle"] == "V" and "stiffness" in run and "backlash_gap" not in run
lines = open("a/curve.csv").read().split()
curve = run.tables["curve"]
assert list(curve) == lines[0].split(",") and len(curve["force_n"]) == len(lines) - 1
assert curve["force_n"][3] == float(lines[4].split(",")[1])
assert set(run.tables["densities"]["quantity"]) == {"deflection_m", "velocity_mps"}
assert abs(run.tables["convergence"]["coulomb_n"][-1] / run["coulomb"].value - 1) < 1e-8
)");
  EXPECT_EQ(outcome.code, 0) << outcome.output << outcome.error;
}

constexpr const char* kManyRuns = R"(
import dampline, numpy
table = dampline.load_many("runs/*")
assert {len(column) for column in table.values()} == {3}
assert list(table["run"]) == ["runs/a", "runs/b", "runs/c"], table["run"]
assert list(table["vehicle"]) == ["V", None, None]
assert str(table["start"].dtype) == "datetime64[us]" and numpy.isnat(table["start"][2])
assert numpy.all(table["coulomb_n"][:2] > 7000) and table["coulomb_std_n"][0] > 0
assert numpy.isnan(table["stiffness_npm"][2]) and abs(table["coulomb_n"][2] - 1200) < 50
)";

TEST_F(Analysis, LoadManyMakesATable) {
  simulate("a.log");
  simulate("b.csv", "--seed 2");
  write_rig("c.csv");
  program_.write("car.toml", "[record]\nvehicle = \"V\"\n");
  expect_success("identify a.log --config car.toml --quiet --no-report --out runs/a");
  expect_success("identify b.csv --quiet --no-report --out runs/b");
  expect_success("identify c.csv --quiet --no-report --out runs/c");
  const auto outcome = python(kManyRuns);
  EXPECT_EQ(outcome.code, 0) << outcome.output << outcome.error;
  if (!has_module("pandas")) GTEST_SKIP() << "the rest needs python3-pandas";
  const auto framed = python(std::string{kManyRuns} + R"(
import pandas
frame = pandas.DataFrame(table)
assert frame.shape == (3, len(table))
trucks = frame[frame["kind"] == "truck"]
assert abs(trucks["coulomb_n"].mean() - table["coulomb_n"][:2].mean()) < 1e-9
assert str(frame["start"].dt.year.iloc[0]).startswith("2023") and frame["start"].isna().sum() == 2
assert list(frame.columns) == list(table)
)");
  EXPECT_EQ(framed.code, 0) << framed.output << framed.error;
}

using Octave = RunFilesTest;

TEST_F(Octave, LoadsARun) {
  if (shell("command -v octave-cli").code != 0) GTEST_SKIP() << "no octave";
  simulate("run.log");
  expect_success("identify run.log --quiet --no-report --out a");
  program_.write("test.m", "addpath ('" DAMPLINE_SOURCE_DIR R"(/app/analysis');
run = loadrun ('a');
assert (size (run.tables.curve.force_n), [18, 1]);
assert (run.tables.densities.quantity{1}, 'deflection_m');
assert (run.about.start_utc, '2023-11-14T22:13:20.000190Z');
assert (isempty (run.tables.excluded.reason));
printf ('%.17g %.17g %s %.17g\n', run.coulomb.value, run.coulomb.std, run.coulomb.unit, ...
        run.tables.curve.force_n(4));
)");
  const auto outcome = shell("octave-cli --norc test.m");
  const json coulomb = json::parse(program_.read("a/parameters.json")).at("parameters").at(0);
  double value = 0.0;
  double std = 0.0;
  ASSERT_EQ(std::sscanf(outcome.output.c_str(), "%lf %lf N", &value, &std), 2)
      << outcome.output << outcome.error;
  EXPECT_EQ(value, coulomb.at("value").get<double>());
  EXPECT_EQ(std, coulomb.at("std").get<double>());
}

}  // namespace
}  // namespace dampline::app

// SPDX-License-Identifier: MIT
// What the program says of records that it must not trust, and of those that it may.
#include "app/run/trust.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(Trust, FrictionThatFallsBeyondTheMotionStatesNoLevel) {
  RunResult result;
  result.kind = "truck";
  result.parameters = {{"coulomb", 5000.0, 50.0, "N"},
                       {"stiffness", 2e6, 1e4, "N/m"},
                       {"stribeck_speed", 0.01, 0.004, "m/s"}};
  result.fit.held_out_nmse = 0.02;
  result.fit.velocity_rms_mps = 0.025;
  const Explaining judged{.judged = true};
  judge_trust(&judged, result);
  EXPECT_EQ(result.trust, Trust::kTrusted) << result.headline;
  result.fit.velocity_rms_mps = 0.015;
  judge_trust(&judged, result);
  EXPECT_EQ(result.trust, Trust::kModelIncomplete);
  EXPECT_THAT(result.headline, HasSubstr("0.67 times the rms velocity"));
}

/// time, frame, wheelset 1, wheelset 2.
using Row = std::array<double, 4>;

class Trusting : public testing::Test {
 protected:
  void simulate(const std::string& more = "--seed 31") const {
    ASSERT_EQ(
        program_
            .run("simulate --duration 120 --quiet --force --out run.csv --config-out car.toml " +
                 more)
            .code,
        0);
  }
  /// The record with every row changed.
  void change(const std::function<void(Row&)>& what) const {
    std::istringstream in{program_.read("run.csv")};
    std::ostringstream out;
    std::string line;
    while (std::getline(in, line)) {
      Row row{};
      std::istringstream cells{line};
      std::string cell;
      std::size_t n = 0;
      const bool numbers = !line.empty() && (std::isdigit(line[0]) != 0 || line[0] == '-');
      while (numbers && n < row.size() && std::getline(cells, cell, ','))
        row[n++] = std::stod(cell);
      if (!numbers) {
        out << line << '\n';
        continue;
      }
      what(row);
      out << std::setprecision(10) << row[0] << ',' << row[1] << ',' << row[2] << ',' << row[3]
          << '\n';
    }
    program_.write("run.csv", out.str());
  }
  [[nodiscard]] json identified(int code) const {
    const auto outcome = program_.run(
        "identify run.csv --config car.toml --out i --force --json --no-report --strict");
    EXPECT_EQ(outcome.code, code) << outcome.error;
    return json::parse(outcome.output);
  }
  /// parameters.json after explain, which says the same trust everywhere.
  [[nodiscard]] json explained(int code) const {
    const auto outcome = program_.run("explain run.csv --config car.toml --out e --force --strict");
    EXPECT_EQ(outcome.code, code) << outcome.error;
    const json found = json::parse(program_.read("e/parameters.json"));
    const json explanation = json::parse(program_.read("e/explanation.json"));
    EXPECT_EQ(found.at("trust"), explanation.at("trust"));
    EXPECT_EQ(found.at("trust_reasons"), explanation.at("trust_reasons"));
    EXPECT_THAT(outcome.output, HasSubstr("trust  " + found.at("trust").get<std::string>()));
    return found;
  }
  Program program_;
};

bool states_a_number(const json& found) {
  const auto headline = found.at("headline").get<std::string>();
  return headline.find("±") != std::string::npos || headline.find("N ") != std::string::npos;
}

double value_of(const json& parameters, const std::string& name) {
  for (const json& p : parameters)
    if (p.at("name") == name) return p.at("value").get<double>();
  ADD_FAILURE() << "no " << name;
  return 0.0;
}

TEST_F(Trusting, ACleanRecordIsTrusted) {
  for (const char* car : {"--load laden --speed-kmh 60", "--load empty --speed-kmh 80"}) {
    simulate(car);
    const json found = identified(0);
    EXPECT_EQ(found.at("trust"), "trusted") << found.at("trust_reasons");
    EXPECT_THAT(found.at("trust_reasons"), IsEmpty());
    EXPECT_TRUE(states_a_number(found));
    EXPECT_FALSE(found.contains("base"));
  }
}

TEST_F(Trusting, ChannelsThatAreExchangedStateNothing) {
  simulate();
  change([](Row& row) { std::swap(row[1], row[2]); });
  const json found = identified(3);
  EXPECT_THAT(found.at("trust").get<std::string>(), AnyOf("not_identified", "data_faulty"));
  EXPECT_FALSE(states_a_number(found)) << found.at("headline");
  const json final = explained(3);
  EXPECT_FALSE(states_a_number(final)) << final.at("headline");
  const json explanation = json::parse(program_.read("e/explanation.json"));
  EXPECT_THAT(explanation.at("verdict").get<std::string>(),
              AnyOf("unexplained", "partly_explained"));
}

TEST_F(Trusting, AFrameInGStatesNothing) {
  simulate();
  change([](Row& row) { row[1] /= 9.80665; });
  const json found = identified(3);
  EXPECT_FALSE(states_a_number(found)) << found.at("headline");
  const json final = explained(3);
  EXPECT_NE(final.at("trust"), "trusted");
  EXPECT_FALSE(states_a_number(final)) << final.at("headline");
  const json explanation = json::parse(program_.read("e/explanation.json"));
  EXPECT_THAT(explanation.at("trust_reasons").dump(), HasSubstr("times as much as the wheelsets"));
  EXPECT_EQ(explanation.at("verdict"), "unexplained");
  for (const json& step : explanation.at("steps")) EXPECT_EQ(step.at("effect"), "unknown");
}

TEST_F(Trusting, AccelerationsInGAreAskedFor) {
  simulate();
  change([](Row& row) {
    for (std::size_t c = 1; c < row.size(); ++c) row[c] /= 9.80665;
  });
  const json found = identified(3);
  EXPECT_EQ(found.at("trust"), "data_faulty");
  EXPECT_THAT(found.at("trust_reasons").dump(), HasSubstr("in g?"));
  EXPECT_FALSE(states_a_number(found)) << found.at("headline");
  const auto outcome = program_.run("explain run.csv --config car.toml --out e");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.error, AllOf(HasSubstr("too short to explain"), HasSubstr("in g?")));
}

TEST_F(Trusting, AWheelsetThatIsACopyIsAFault) {
  simulate();
  change([](Row& row) { row[3] = row[2]; });
  const json found = identified(3);
  EXPECT_EQ(found.at("trust"), "data_faulty");
  EXPECT_THAT(found.at("trust_reasons").dump(), HasSubstr("identical_channels (wheelsets)"));
  EXPECT_FALSE(states_a_number(found)) << found.at("headline");
  EXPECT_EQ(explained(3).at("trust"), "data_faulty");
}

/// A whole car, of which three accelerometers see one truck.
TEST_F(Trusting, AModelThatDoesNotFitNamesExplain) {
  simulate("--vehicle leading --load empty --seed 32");
  const json found = identified(3);
  EXPECT_EQ(found.at("trust"), "model_incomplete");
  EXPECT_THAT(found.at("trust_reasons").dump(), HasSubstr("`dampline explain`"));
  EXPECT_FALSE(states_a_number(found)) << found.at("headline");
  const auto lax = program_.run("identify run.csv --config car.toml --out lax");
  EXPECT_EQ(lax.code, 0);
  EXPECT_THAT(lax.output, AllOf(HasSubstr("model_incomplete"), HasSubstr("are lower bounds")));
  EXPECT_TRUE(found.at("std_is_lower_bound"));
  EXPECT_THAT(program_.read("lax/report.html"),
              HasSubstr("Trust</dt><dd class=\"value\">model incomplete<"));
}

TEST_F(Trusting, TheResultOfAnExplanationIsTheFinalLaw) {
  simulate("--effect viscous:coefficient_nspm=120000 --seed 33");
  EXPECT_EQ(identified(3).at("trust"), "model_incomplete");
  const json base = json::parse(program_.read("i/parameters.json"));
  const json found = explained(0);
  EXPECT_EQ(found.at("trust"), "trusted") << found.at("trust_reasons");
  EXPECT_TRUE(base.at("std_is_lower_bound"));
  EXPECT_FALSE(found.at("std_is_lower_bound"));
  const json explanation = json::parse(program_.read("e/explanation.json"));
  EXPECT_EQ(found.at("parameters"), explanation.at("final").at("parameters"));
  EXPECT_EQ(found.at("base").at("parameters"), explanation.at("base").at("parameters"));
  EXPECT_EQ(found.at("base").at("parameters"), base.at("parameters"));
  EXPECT_EQ(found.at("model"), explanation.at("final").at("terms"));
  EXPECT_NEAR(value_of(found.at("parameters"), "coulomb"), 8356.0, 0.02 * 8356.0);
  EXPECT_NEAR(value_of(found.at("parameters"), "viscous"), 120000.0, 0.1 * 120000.0);
  EXPECT_GT(value_of(found.at("base").at("parameters"), "coulomb"), 1.1 * 8356.0);
  EXPECT_DOUBLE_EQ(found.at("fit").at("held_out_nmse").get<double>(),
                   explanation.at("final").at("held_out_nmse").get<double>());
  double left = explanation.at("base").at("held_out_nmse").get<double>();
  for (const json& step : explanation.at("steps")) {
    EXPECT_EQ(step.at("held_out_nmse_before"), left);
    left = step.at("held_out_nmse_after").get<double>();
    for (const json& other : step.at("runners_up"))
      EXPECT_GT(other.at("held_out_nmse").get<double>(), left);
  }
  EXPECT_EQ(explanation.at("final").at("held_out_nmse"), left);
}

/// The curve's nodes lie on Fc + c v, within the band, and what settles is that law.
TEST_F(Trusting, CurveAndConvergenceAreOfTheFinalLaw) {
  simulate("--effect viscous:coefficient_nspm=120000 --seed 33");
  ASSERT_EQ(explained(0).at("trust"), "trusted");
  std::istringstream curve{program_.read("e/curve.csv")};
  std::string line;
  std::getline(curve, line);
  int nodes = 0;
  while (std::getline(curve, line)) {
    double v = 0.0;
    double force = 0.0;
    double std = 0.0;
    char comma = ',';
    std::istringstream{line} >> v >> comma >> force >> comma >> std;
    if (v == 0.0) continue;
    const double truth = std::copysign(8356.0, v) + 120000.0 * v;
    EXPECT_NEAR(force, truth, 0.02 * std::abs(truth)) << line;
    EXPECT_GT(std, 0.0);
    EXPECT_LT(std, 0.02 * std::abs(truth));
    ++nodes;
  }
  EXPECT_EQ(nodes, 16);
  const std::string convergence = program_.read("e/convergence.csv");
  EXPECT_THAT(convergence, HasSubstr("viscous_nspm"));
  EXPECT_GT(std::count(convergence.begin(), convergence.end(), '\n'), 10);
  const std::string page = program_.read("e/report.html");
  EXPECT_THAT(page.substr(0, page.find("<script>")),  // what stands before uPlot
              AllOf(HasSubstr("The model before"),
                    HasSubstr("Trust</dt><dd class=\"value\">trusted<"), Not(HasSubstr("nan"))));
}

}  // namespace
}  // namespace dampline::app

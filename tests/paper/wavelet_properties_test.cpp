// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "app/error.hpp"
#include "app/verify/oscillator/accuracy.hpp"
#include "app/verify/subjects.hpp"
#include "app/verify/wavelet/properties.hpp"

namespace dampline::app {
namespace {

double found(const CheckGroup& group, const std::string& what) {
  const auto it = std::find_if(group.checks.begin(), group.checks.end(),
                               [&](const Check& check) { return check.what == what; });
  EXPECT_NE(it, group.checks.end()) << what;
  return it == group.checks.end() ? NAN : it->found;
}

/// `true_mse_percent`: as published, one per system.
void expect_selection(const std::vector<CheckGroup>& groups,
                      const std::vector<double>& true_mse_percent) {
  ASSERT_EQ(groups.size(), true_mse_percent.size());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const double true_mse = found(groups[i], "MSE, true model, D8");
    EXPECT_LT(true_mse, true_mse_percent[i]) << groups[i].title;
    EXPECT_GT(true_mse, 0.0);
    EXPECT_GE(found(groups[i], "MSE, linear model, D8"), 100.0 * true_mse) << groups[i].title;
    EXPECT_GE(found(groups[i], "MSE, best model without one of the true terms, D8"),
              100.0 * true_mse)
        << groups[i].title;
    EXPECT_GT(found(groups[i], "least |t| of a true term, D16"), 10.0) << groups[i].title;
    EXPECT_LT(found(groups[i], "largest |t| of a spurious term, D16"), 4.0) << groups[i].title;
    EXPECT_EQ(found(groups[i], "terms chosen wrongly or missed, D8"), 0.0) << groups[i].title;
    EXPECT_EQ(found(groups[i], "terms chosen wrongly or missed, D16"), 0.0) << groups[i].title;
  }
}

TEST(Table17, TellsTrueTermsFromSpuriousOnes) {
  expect_selection(single_selection(), {2.2e-10, 2.9e-7, 1.2e-3, 5.6e-8});
}

TEST(Table18, TellsTrueTermsFromSpuriousOnes) {
  expect_selection(chain_selection(), {4.8e-10, 1.6e-10, 3.6e-9, 1.8e-9, 1.1e-9, 2.17e-10});
}

/// Equation 35 between simulated responses: what tables 17 and 18 print of linear models.
TEST(Equation35, ComparesResponses) {
  std::size_t near = 0;
  for (const auto& groups : {single_responses(), chain_responses()}) {
    for (const CheckGroup& group : groups) {
      for (const Check& check : group.checks) {
        if (!check.is_bound()) continue;
        ++near;
        EXPECT_NEAR(check.found / check.published->value, 1.0, 0.2) << group.title << check.what;
      }
    }
  }
  EXPECT_EQ(near, 7U);
}

TEST(Sweep, FitsThePublishedScatterBetterWithHalfTheSlope) {
  const CheckGroup group = sweep_readings().front();
  EXPECT_LT(found(group, "half of that slope, whole sweep"), 4.0);
  EXPECT_GT(found(group, "phase of equations 21 to 23, whole sweep"), 4.0);
}

TEST(TwoAccelerometers, NeedNoDeflectionAndNoForce) {
  const auto at_two_hz = strong_conditions()[1];
  const OscillatorAccuracy found = accuracy_of(at_two_hz, System::kDuffing, {.count = 3});
  EXPECT_EQ(found.estimates, 3);
  EXPECT_NEAR(found.rms_g, 0.25, 0.05);
  const std::vector<double> demanded{0.004, 0.002, 0.006};
  ASSERT_EQ(found.parameters.size(), demanded.size());
  for (std::size_t i = 0; i < demanded.size(); ++i) {
    EXPECT_NEAR(found.parameters[i].demanded, demanded[i], 1e-12) << found.parameters[i].name;
    EXPECT_LE(found.parameters[i].rms_error, demanded[i]) << found.parameters[i].name;
    EXPECT_GE(found.parameters[i].rms_error, std::abs(found.parameters[i].mean_error));
  }
}

TEST(TwoAccelerometers, MissTheirFigureWhenASeedGivesNoEstimate) {
  OscillatorCondition too_short;
  too_short.change = [](sim::AccelerometerRunConfig& config) { config.duration_s = 10.0; };
  const OscillatorAccuracy found = accuracy_of(too_short, System::kLinear, {.count = 1});
  EXPECT_EQ(found.estimates, 0);
  for (const ParameterAccuracy& one : found.parameters) EXPECT_FALSE(one.met()) << one.name;
}

TEST(StiffnessDrop, IsFoundWithinOneWindow) {
  const CheckGroup group = stiffness_drop().front();
  EXPECT_LE(found(group, "samples until k is within 1e-4 of its new value, for good"), 45.0);
  EXPECT_GE(found(group, "samples until k is within 1e-4 of its new value, for good"), 10.0);
  EXPECT_NEAR(found(group, "k by the first window after the drop"), 0.8, 1e-5);
}

TEST(Recursive, EqualsBatch) {
  const CheckGroup group = recursive_against_batch().front();
  EXPECT_LE(found(group, "whole run, double"), 1e-12);
  EXPECT_LE(found(group, "windows of 32 rows, ring of 4 factors, double"), 1e-10);
  EXPECT_LE(found(group, "whole run, single"), 1e-4);
  EXPECT_GT(found(group, "whole run, single"), 1e-9);
}

TEST(TwelveBits, NeedACoarserLevel) {
  const CaseFigures figures = quantised_duffing_result();
  for (const ParameterFigures& parameter : figures.parameters) {
    const auto& by = parameter.estimates;
    EXPECT_LE(std::abs(by[3].error), 5e-4) << parameter.name << ", " << by[3].method;
    EXPECT_LE(std::abs(by[4].error), 5e-4) << parameter.name << ", " << by[4].method;
    EXPECT_LT(by[4].spread, by[1].spread) << parameter.name;
  }
}

TEST(Bound, IsMissedByWhatIsNotANumber) {
  EXPECT_FALSE((Estimate{.error = NAN, .bound = {.error = 1.0}}.met()));
  EXPECT_FALSE((Estimate{.error = 0.1, .spread = 3.0, .bound = {1.0, 2.0}}.met()));
  EXPECT_FALSE((Estimate{.error = -1.5, .bound = {1.0, 2.0}}.met()));
  EXPECT_TRUE((Estimate{.error = -0.5, .spread = 1.0, .bound = {1.0, 2.0}}.met()));
  EXPECT_FALSE((Check{.found = NAN, .at_most = 1.0}.met()));
  EXPECT_FALSE((Check{.found = 1.0, .at_least = 2.0}.met()));
}

TEST(Bound, IsCountedWhereThereIsOne) {
  WaveletFigures figures;
  figures.groups.push_back(
      {.checks = {{.found = 1.0, .at_most = 2.0}, {.found = 3.0, .at_most = 2.0}, {.found = 5.0}}});
  const Tally count = tally(figures);
  EXPECT_EQ(count.bound, 2U);
  EXPECT_EQ(count.met, 1U);
}

TEST(Bound, IsNamedWhereItIsMissed) {
  const WaveletFigures figures{
      .cases = {{.tables = {"5"},
                 .title = "free",
                 .conditions = "",
                 .notes = {},
                 .parameters = {{.name = "k",
                                 .estimates = {{.method = "D8",
                                                .error = -2.0,
                                                .spread = 3.0,
                                                .bound = {.error = 1.0, .spread = 4.0}},
                                               {.method = "D12", .error = NAN}}}}}},
      .groups = {{.tables = {"17"},
                  .title = "forced",
                  .checks = {{.what = "t", .found = 3.0, .at_least = 10.0},
                             {.what = "u", .found = 30.0, .at_least = 10.0}}}}};
  EXPECT_THAT(missed(figures), testing::ElementsAre("5, free: k by D8, error 2.0e+00 above 1.0e+00",
                                                    "17, forced: t is 3, promised at least 10"));
}

std::string printed(const VerifyOptions& options) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(verify_wavelet(options), 0);
  return testing::internal::GetCapturedStdout();
}

TEST(VerifyWavelet, PrintsATableInEveryForm) {
  const auto json = nlohmann::json::parse(printed({.json = true, .tables = {"12"}}));
  const auto& friction = json.at("cases").at(0).at("parameters").at(2);
  EXPECT_EQ(friction.at("name"), "e");
  EXPECT_EQ(friction.at("unit"), "N");
  EXPECT_EQ(friction.at("published").at("value"), 0.206);
  EXPECT_NEAR(friction.at("estimates").at(0).at("value").get<double>(), 0.2, 1e-6);
  const std::string text = printed({.tables = {"12"}});
  EXPECT_NE(text.find("Table 12: Coulomb friction, free"), std::string::npos);
  EXPECT_NE(text.find("11 of 11 bounds met"), std::string::npos) << text;
  const std::string markdown = printed({.markdown = true, .tables = {"12"}});
  EXPECT_NE(markdown.find("| 12 | Coulomb friction, free | e | 0.2 N | 0.206 |"), std::string::npos)
      << markdown;
  const std::string checks = printed({.markdown = true, .tables = {"step"}});
  EXPECT_NE(checks.find("| - | >= 0.7999, <= 0.8001 | 0.8 N/m | yes |"), std::string::npos)
      << checks;
  EXPECT_EQ(printed({.quiet = true, .tables = {"12"}}), "");
}

TEST(VerifyWavelet, RefusesATableThatIsNotThere) {
  EXPECT_THROW(static_cast<void>(verify_wavelet({.quiet = true, .tables = {"2"}})), UsageError);
}

}  // namespace
}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include "app/wavelet/fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "app/error.hpp"
#include "app/verify/oscillator/simulated.hpp"
#include "app/wavelet/deflections.hpp"
#include "app/wavelet/identify.hpp"
#include "tests/rows/simulated.hpp"

namespace dampline::app::wavelet {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Question ask(const char* terms, std::vector<double> mass_kg = {1.0}) {
  return {.terms = {parse_terms(terms)}, .mass_kg = std::move(mass_kg)};
}

/// Relative errors of the terms, in their order.
void expect_values(const WaveletFit& fit, const std::vector<double>& truth, double within) {
  ASSERT_EQ(fit.terms.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i)
    EXPECT_NEAR(fit.terms[i].value, truth[i], within * std::abs(truth[i]))
        << text_of(fit.terms[i].term);
}

class ByWavelet : public testing::TestWithParam<Wavelet> {};

// Truncation of the stencils alone: orders of magnitude apart from D6 to D16.
TEST_P(ByWavelet, ADuffingOscillatorIsFoundToTheStencilsOrder) {
  constexpr std::array kWithin{3e-3, 3e-4, 5e-6, 5e-7};
  const Measured record = test::measured_of(test::driven(test::duffing(), 1.0, 4000));
  Question question = ask("v, x, x^3");
  question.wavelet = GetParam();
  const double within = kWithin[static_cast<std::size_t>(GetParam())];
  expect_values(fit_terms(record, question), {0.6, 25.0, 40.0}, within);
  question.window_rows = 200;
  const WaveletFit windows = fit_terms(record, question);
  expect_values(windows, {0.6, 25.0, 40.0}, 3.0 * within);
  EXPECT_EQ(windows.windows.rows.size() + windows.windows_held, windows.rows / 200);
}
INSTANTIATE_TEST_SUITE_P(All, ByWavelet,
                         testing::Values(Wavelet::kD6, Wavelet::kD8, Wavelet::kD12, Wavelet::kD16));

TEST(Fit, CoarseLevelsSeeTheSameSystem) {
  const Measured record = test::measured_of(test::driven(test::duffing(), 1.0, 24000, 0.005));
  for (const int level : {1, 2, 3}) {
    Question question = ask("v, x, x^3");
    question.wavelet = Wavelet::kD12;
    question.level = level;
    expect_values(fit_terms(record, question), {0.6, 25.0, 40.0}, 1e-4);
  }
}

TEST(Fit, TheMassIsFoundWhereItIsATerm) {
  const Measured record = test::measured_of(test::driven(test::duffing(), 3.0, 4000));
  Question question = ask("a, v, x, x^3", {});
  question.wavelet = Wavelet::kD12;
  expect_values(fit_terms(record, question), {3.0, 0.6, 25.0, 40.0}, 1e-5);
  question = ask("v, x, x^3", {3.0});
  question.wavelet = Wavelet::kD12;
  expect_values(fit_terms(record, question), {0.6, 25.0, 40.0}, 1e-5);
}

// Rows across reversals are left out; with them friction comes out percents wrong.
TEST(Fit, DryFrictionIsExactWhereNoRowReachesAcrossAReversal) {
  const sim::reference::Element element{.k = 25, .c = sim::reference::Real(0.5), .e = 1, .fk = 4};
  const Measured record = test::measured_of(test::driven(element, 1.0, 20000, 0.005));
  Question question = ask("v, x, sign(v), |x|*sign(v)");
  const WaveletFit gated = fit_terms(record, question);
  EXPECT_TRUE(gated.gated);
  expect_values(gated, {0.5, 25.0, 1.0, 4.0}, 1e-5);
  question.gated = false;
  const WaveletFit ungated = fit_terms(record, question);
  EXPECT_GT(std::abs(ungated.terms[0].value - 0.5), 1e-3);
  EXPECT_GT(ungated.rows, gated.rows);
}

TEST(Fit, TwoMassesShareTheElementBetweenThem) {
  const Measured record = test::measured_of(test::driven_chain(6000));
  Question question{.terms = {parse_terms("v, x, x^3"), parse_terms("v, x")},
                    .mass_kg = {2.0, 1.0},
                    .wavelet = Wavelet::kD12};
  expect_values(fit_terms(record, question), {1.0, 60.0, 30.0, 0.4, 20.0}, 1e-4);
  question.terms = {parse_terms("a, v, x, x^3"), parse_terms("a, v, x")};
  question.mass_kg.clear();
  expect_values(fit_terms(record, question), {2.0, 1.0, 60.0, 30.0, 1.0, 0.4, 20.0}, 1e-4);
  question.window_rows = 400;
  expect_values(fit_terms(record, question), {2.0, 1.0, 60.0, 30.0, 1.0, 0.4, 20.0}, 1e-2);
}

TEST(Fit, AForceWithoutInertiaIsTheElements) {
  Measured record = test::measured_of(test::driven(test::duffing(), 1.0, 4000));
  for (std::size_t i = 0; i < record.samples(); ++i) {
    const double x = record.deflection_m[0][i];
    record.force_n[0][i] = 25.0 * x + 40.0 * x * x * x;
  }
  expect_values(fit_terms(record, ask("x, x^3", {})), {25.0, 40.0}, 1e-9);
}

TEST(Fit, TermSetsTellWhatIsMissingAndWhatIsTooMuch) {
  const Measured record =
      test::measured_of(test::driven(test::duffing(), 1.0, 6000), {1e-5, 0.02}, 7);
  Question question = ask("v, x, v^3");
  question.compares = true;
  const WaveletFit fit = fit_terms(record, question);
  const auto set = [&](const std::string& change) {
    for (const TermSet& s : fit.sets)
      if (s.change == change) return s;
    ADD_FAILURE() << change;
    return TermSet{};
  };
  const TermSet asked = set("as asked");
  EXPECT_LT(set("with x^3").held_out_mse_percent, 0.05 * asked.held_out_mse_percent);
  EXPECT_GT(std::abs(set("with x^3").t), 20.0);
  EXPECT_GT(set("without x").held_out_mse_percent, 10.0 * asked.held_out_mse_percent);
  EXPECT_GT(asked.held_out_mse_percent, asked.mse_percent);
  EXPECT_LT(set("with x^2").mse_percent, asked.mse_percent * (1.0 + 1e-9));
  EXPECT_EQ(fit.sets.back().change, "chosen of all: v + x + x^3");
}

TEST(Fit, ErrorsSayWhatTheRecordLacks) {
  const auto fit = [](const Measured& record, const Question& question) {
    return [&record, question] { static_cast<void>(fit_terms(record, question)); };
  };
  const Measured few = test::measured_of(test::driven(test::duffing(), 1.0, 20));
  EXPECT_THAT(fit(few, ask("v, x, x^3")),
              ThrowsMessage<RunError>(HasSubstr("7 usable rows in 20")));
  const Measured record = test::measured_of(test::driven(test::duffing(), 1.0, 2000));
  Question question = ask("v, x");
  question.window_rows = 1500;
  EXPECT_THAT(fit(record, question), ThrowsMessage<RunError>(HasSubstr("found 1 windows")));
  Measured still = record;
  for (double& x : still.deflection_m[0]) x = 0.0;
  EXPECT_THAT(fit(still, ask("v, x")), ThrowsMessage<RunError>(HasSubstr("do not determine")));
  EXPECT_THAT(fit(record, ask("x,x^2,x^3,x^4,x^5,x^6,x^7,x^8,x^9,v,v^2,v^3,v^4,v^5,v^6,v^7,v^8,v^9,"
                              "x*v,x^2*v,x^3*v,x^4*v,x^5*v,x^6*v,x^7*v")),
              ThrowsMessage<UsageError>(HasSubstr("at most 24")));
}

/// A base that shakes an oscillator, as two accelerometers see it.
Measured accelerations_of(const sim::AccelerometerRun& run) {
  Measured out;
  out.name = "accelerations";
  out.step_s = 1.0 / 300.0;
  for (std::size_t i = 0; i < run.mass_mps2.size(); ++i) {
    out.time_s.push_back(static_cast<double>(i) * out.step_s);
    out.deflection_m[0].push_back(run.mass_mps2[i]);
    out.force_n[0].push_back(run.base_mps2[i]);
  }
  out.stretches = {{0, out.samples()}};
  out.duration_s = out.time_s.back();
  return deflections_from_accelerations(out, 4.0);
}

/// 3 Hz, a tenth of critical damping; the mass accelerates by 0.25 g rms.
sim::AccelerometerRun shaken(sim::OscillatorConfig oscillator) {
  constexpr double kRmsMps2 = 0.25 * 9.80665;
  sim::AccelerometerRunConfig config;
  oscillator.viscous_ps = 3.77;
  oscillator.stiffness_ps2 = 355.3;
  config.oscillator = oscillator;
  config.seed = 99;
  config.base_rms_mps2 = sim::base_rms_for(config, kRmsMps2);
  return sim::run_accelerometers(config);
}

void expect_within(const WaveletFit& fit, const std::vector<double>& truth,
                   const std::vector<double>& within) {
  ASSERT_EQ(fit.terms.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i)
    EXPECT_NEAR(fit.terms[i].value, truth[i], within[i] * truth[i]) << text_of(fit.terms[i].term);
}

TEST(Accelerations, OscillatorsAreFoundFromBaseAndResponse) {
  expect_within(fit_terms(accelerations_of(shaken({})), ask("v, x", {})), {3.77, 355.3},
                {0.01, 0.003});
  constexpr double kCubic = 0.1 * 355.3 / (0.0069 * 0.0069);
  expect_within(
      fit_terms(accelerations_of(shaken({.cubic_stiffness_pm2s2 = kCubic})), ask("v, x, x^3", {})),
      {3.77, 355.3, kCubic}, {0.01, 0.003, 0.02});
  expect_within(
      fit_terms(accelerations_of(shaken({.coulomb_mps2 = 0.49})), ask("v, x, sign(v)", {})),
      {3.77, 355.3, 0.49}, {0.06, 0.005, 0.02});
}

TEST(Accelerations, AMassTurnsThemIntoForces) {
  const WaveletFit fit = fit_terms(accelerations_of(shaken({})), ask("v, x", {20.0}));
  expect_within(fit, {20.0 * 3.77, 20.0 * 355.3}, {0.01, 0.003});
}

}  // namespace
}  // namespace dampline::app::wavelet

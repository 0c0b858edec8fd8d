// SPDX-License-Identifier: MIT
// Stated deviations hold the truth: many records of one system, each with noise of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "app/wavelet/fit.hpp"
#include "app/wavelet/identify.hpp"
#include "tests/rows/simulated.hpp"

namespace dampline::app::wavelet {
namespace {

constexpr std::uint64_t kSeeds = 60;

struct Covered {
  double share{0.0};       ///< of all estimates of all seeds, within two deviations
  double worst_bias{0.0};  ///< mean error over mean deviation, of any term
};

Covered covered(const test::Trajectory& truth, const test::Noise& noise, Question question,
                const std::vector<double>& values) {
  question.level = level_for(test::measured_of(truth, noise), question);
  std::vector<double> error(values.size());
  std::vector<double> deviation(values.size());
  double within = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const WaveletFit fit = fit_terms(test::measured_of(truth, noise, 1000 + seed), question);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const TermEstimate& t = fit.terms[i];
      error[i] += t.value - values[i];
      deviation[i] += t.std;
      if (std::abs(t.value - values[i]) <= 2.0 * t.std) within += 1.0;
    }
  }
  Covered out{within / static_cast<double>(kSeeds * values.size())};
  for (std::size_t i = 0; i < values.size(); ++i)
    out.worst_bias = std::max(out.worst_bias, std::abs(error[i]) / deviation[i]);
  testing::Test::RecordProperty("level", question.level);
  testing::Test::RecordProperty("share", std::to_string(out.share));
  return out;
}

void expect_covered(const Covered& found) {
  EXPECT_GE(found.share, 0.90);
  EXPECT_LE(found.share, 0.99);
  EXPECT_LT(found.worst_bias, 0.5) << "deviations";
}

TEST(Coverage, OfAnOscillatorWithAKnownMass) {
  Question question{.terms = {parse_terms("v, x, x^3")}, .mass_kg = {1.0}};
  question.wavelet = Wavelet::kD12;
  expect_covered(
      covered(test::driven(test::duffing(), 1.0, 6000), {5e-5, 0.1}, question, {0.6, 25.0, 40.0}));
}

// Noise of the deflection makes an identified mass small: with 5e-5 m by 0.6 deviations.
TEST(Coverage, OfAnOscillatorWhoseMassIsIdentified) {
  Question question{.terms = {parse_terms("a, v, x, x^3")}, .mass_kg = {}};
  question.wavelet = Wavelet::kD12;
  expect_covered(covered(test::driven(test::duffing(), 3.0, 6000), {3e-5, 0.1}, question,
                         {3.0, 0.6, 25.0, 40.0}));
}

TEST(Coverage, OfDryFriction) {
  const sim::reference::Element element{.k = 25, .c = sim::reference::Real(0.5), .e = 1};
  const Question question{.terms = {parse_terms("v, x, sign(v)")}, .mass_kg = {1.0}};
  expect_covered(
      covered(test::driven(element, 1.0, 30000, 0.004), {1e-6, 0.1}, question, {0.5, 25.0, 1.0}));
}

TEST(Coverage, OfTwoMasses) {
  Question question{.terms = {parse_terms("v, x, x^3"), parse_terms("v, x")},
                    .mass_kg = {2.0, 1.0}};
  question.wavelet = Wavelet::kD12;
  expect_covered(
      covered(test::driven_chain(6000), {2e-5, 0.1}, question, {1.0, 60.0, 30.0, 0.4, 20.0}));
}

TEST(Coverage, OfTheWindowsMean) {
  Question question{.terms = {parse_terms("v, x, x^3")}, .mass_kg = {1.0}, .window_rows = 100};
  question.wavelet = Wavelet::kD12;
  expect_covered(
      covered(test::driven(test::duffing(), 1.0, 6000), {5e-6, 0.02}, question, {0.6, 25.0, 40.0}));
}

}  // namespace
}  // namespace dampline::app::wavelet

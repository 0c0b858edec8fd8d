// SPDX-License-Identifier: MIT
#include "dampline/density/paper_form.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "sim_hw/noise.hpp"
#include "tests/density/white_run.hpp"

namespace dampline {
namespace {

// The region around v = 0 left in: the criterion's part without unknowns grows as the kernel
// shrinks, about fourfold a halving, and the level with it.
TEST(PaperForm, DivergesWithoutTheExclusion) {
  const auto run = white_run({.seed = 31}, 300.0);
  double last = 0.0;
  for (const double bandwidth_mps : {4.0e-3, 2.0e-3, 1.0e-3, 0.5e-3}) {
    const PaperForm form = run->paper_form(kMassKg, kStiffnessNpm, bandwidth_mps, 0.0);
    ASSERT_TRUE(form.ok);
    if (last > 0.0) {
      EXPECT_GT(form.integrals.aa / last, 2.5);
    }
    last = form.integrals.aa;
  }
  const auto level_n = [&](double bandwidth_mps, double excluded_mps) {
    return 0.5 * kMassKg *
           run->paper_form(kMassKg, kStiffnessNpm, bandwidth_mps, excluded_mps).level_mps2();
  };
  EXPECT_LT(level_n(4.0e-3, 0.0), 0.8 * kLevelN);
  EXPECT_NEAR(level_n(2.0e-3, 6.0e-3), kLevelN, 0.05 * kLevelN);
}

// Of an exact Laplace density alpha is the same everywhere, and the integrals have closed forms:
// with p = exp(-|v| / l) / (2 l), int p^2 = 1 / (4 l), int p'^2 = 1 / (4 l^3), int p p'' > |v0| the
// same.
TEST(PaperForm, OfAnExactDensityIsExact) {
  constexpr double kLengthMps = 6.0e-3;
  constexpr double kInputLevel = 5.0e-3;
  const auto velocities =
      std::make_unique<VelocityHistogram>(HistogramConfig{.range = {.low = -0.064, .high = 0.064}});
  DeflectionHistogram deflections{{.range = {.low = -4.0e-3, .high = 4.0e-3}}};
  const auto fill = [](auto& histogram, auto density) {
    for (std::size_t b = 0; b < std::decay_t<decltype(histogram)>::kBins; ++b) {
      const double x = histogram.axis().centre(b);
      const auto samples = std::lround(2.0e5 * density(x));
      for (long i = 0; i < samples; ++i) histogram.update(x);
    }
  };
  fill(*velocities, [&](double v) { return std::exp(-std::abs(v) / kLengthMps); });
  fill(deflections, [](double y) { return std::exp(-0.5 * y * y / 1.0e-6); });
  const auto over_y = deflection_integrals(deflections, {1.0});
  EXPECT_NEAR(over_y.p1_p1 * 2.0 * std::sqrt(std::numbers::pi) * 1.0e-3, 1.0, 1e-3);
  EXPECT_NEAR(over_y.p1_dp1 / over_y.p1_p1, 0.0, 1e-6);
  EXPECT_NEAR(over_y.y_p1_p1 / over_y.p1_p1, 0.0, 1e-7);
  const PaperForm form = fit_paper_form(*velocities, over_y,
                                        {.beta = 280.0,
                                         .input_level = kInputLevel,
                                         .bandwidth_mps = 0.6e-3,
                                         .excluded_mps = 3.0e-3,
                                         .reach_mps = 0.03});
  ASSERT_TRUE(form.ok);
  EXPECT_NEAR(form.level_mps2() / (0.5 * kInputLevel / kLengthMps), 1.0, 5e-3);
  EXPECT_NEAR(form.offset(), 0.0, 1e-9);
  EXPECT_EQ(form.used, 10U);
  EXPECT_EQ(form.segments[1][form.used - 1].to_mps, 0.03);
  for (std::size_t i = 0; i < form.used; ++i) {
    const PaperSegment& s = form.segments[1][i];
    EXPECT_NEAR(s.alpha_mps2 / (0.5 * kInputLevel / kLengthMps), 1.0, 0.02);
  }
  // Smoothing by a Gaussian multiplies the tails by exp(h^2 / 2 l^2).
  const double gain = std::exp(0.01);                  // of p^2
  const double tail = std::exp(-6.0e-3 / kLengthMps);  // of p^2, from 3 mm/s on
  EXPECT_NEAR(form.integrals.cc / (gain * tail / (4.0 * kLengthMps)), 1.0, 0.02);
  EXPECT_NEAR(form.integrals.bb / (gain * tail / (4.0 * std::pow(kLengthMps, 3))), 1.0, 0.02);
  EXPECT_NEAR(
      form.integrals.ac / (0.5 * kInputLevel * gain * tail / (4.0 * std::pow(kLengthMps, 3))), 1.0,
      0.02);
}

template <class Histogram, class Density>
void fill_with(Histogram& histogram, double samples, const Density& density) {
  for (std::size_t b = 0; b < Histogram::kBins; ++b) {
    const double x = histogram.axis().centre(b);
    for (long i = std::lround(samples * density(x)); i > 0; --i) histogram.update(x);
  }
}

// p1^2 of a Gaussian about 0.4 mm, s = 0.7 mm, is one of s / sqrt(2).
TEST(PaperForm, IntegratesOverADeflectionThatIsNotSymmetric) {
  constexpr double kMeanMm = 0.4;
  constexpr double kVarianceMm2 = 0.49 / 2.0;
  DeflectionHistogram deflections{{.range = {.low = -4.0e-3, .high = 4.0e-3}}};
  fill_with(deflections, 2.0e5,
            [](double y) { return std::exp(-0.5 * std::pow((y - 1e-3 * kMeanMm) / 0.7e-3, 2)); });
  const auto over_y = deflection_integrals(deflections, {1.0, 0.5, 0.3});
  const auto moment = [&](int order) {  // of y in mm
    const double m = kMeanMm;
    const double v = kVarianceMm2;
    return std::array{
        1.0, m, m * m + v, m * m * m + 3.0 * m * v,
        std::pow(m, 4) + 6.0 * m * m * v + 3.0 * v * v}[static_cast<std::size_t>(order)];
  };
  EXPECT_NEAR(over_y.p1_p1 * 2.0 * std::sqrt(std::numbers::pi) * 0.7e-3, 1.0, 1e-3);
  EXPECT_NEAR(1e3 * over_y.y_p1_p1 / over_y.p1_p1, kMeanMm, 1e-4);
  EXPECT_NEAR(over_y.psi2_p1_p1 / over_y.p1_p1, 1.0 + 0.5 * moment(1) + 0.3 * moment(2), 1e-3);
  EXPECT_NEAR(over_y.psi4_p1_p1 / over_y.p1_p1,
              1.0 + moment(1) + 0.85 * moment(2) + 0.3 * moment(3) + 0.09 * moment(4), 1e-3);
  EXPECT_NEAR(over_y.p1_dp1 / over_y.p1_p1, 0.0, 1e-6) << "half of p1^2 from end to end";
}

// Two exponentials, of 5 mm/s in negative motion and 8 mm/s in positive: another force on either
// side, and integrals of odd products that do not cancel.
TEST(PaperForm, TellsTheSidesApart) {
  constexpr double kInputLevel = 5.0e-3;
  constexpr std::array kLengthMps{5.0e-3, 8.0e-3};
  constexpr double kFromMps = 3.0e-3;
  const auto velocities =
      std::make_unique<VelocityHistogram>(HistogramConfig{.range = {.low = -0.064, .high = 0.064}});
  fill_with(*velocities, 2.0e5, [&](double v) {
    return std::exp(-std::abs(v) / (v < 0.0 ? kLengthMps[0] : kLengthMps[1]));
  });
  const DeflectionIntegrals over_y{
      .p1_p1 = 2.0, .psi2_p1_p1 = 3.0, .psi4_p1_p1 = 5.0, .y_p1_p1 = 0.0};
  const PaperFormConfig config{.beta = 280.0,
                               .input_level = kInputLevel,
                               .bandwidth_mps = 0.5e-3,
                               .excluded_mps = kFromMps,
                               .reach_mps = 0.03};
  const PaperForm form = fit_paper_form(*velocities, over_y, config);
  ASSERT_TRUE(form.ok);
  const double half_level = 0.5 * kInputLevel * 1.5;  // psi^2 weighs by p1^2
  EXPECT_NEAR(form.mean_mps2[0] / (-half_level / kLengthMps[0]), 1.0, 0.01);
  EXPECT_NEAR(form.mean_mps2[1] / (half_level / kLengthMps[1]), 1.0, 0.01);
  EXPECT_NEAR(form.offset(), 0.5 * half_level * (1.0 / kLengthMps[1] - 1.0 / kLengthMps[0]),
              0.01 * half_level / kLengthMps[1]);
  EXPECT_EQ(form.segments[0][4].from_mps, 4 * 0.003);
  // int of p^2 beyond 3 mm/s of either side, smoothed.
  std::array<double, 2> squares{};
  for (std::size_t s = 0; s < 2; ++s) {
    const double l = kLengthMps[s];
    const double smoothed = std::exp(std::pow(config.bandwidth_mps / l, 2));
    squares[s] = smoothed * 0.5 * l * std::exp(-2.0 * kFromMps / l) /
                 std::pow(kLengthMps[0] + kLengthMps[1], 2);
  }
  const auto sum = [&](int order) {  // with p' = p / l and -p / l
    return squares[0] * std::pow(1.0 / kLengthMps[0], order) +
           squares[1] * std::pow(-1.0 / kLengthMps[1], order);
  };
  const PaperIntegrals& x = form.integrals;
  const double half = 0.5 * kInputLevel;
  EXPECT_NEAR(x.cc / sum(0), 1.0, 0.02);
  EXPECT_NEAR(x.bc / sum(1), 1.0, 0.05);
  EXPECT_NEAR(x.bb / sum(2), 1.0, 0.02);
  EXPECT_NEAR(x.ac / (1.5 * half * sum(2)), 1.0, 0.02);
  EXPECT_NEAR(x.ab / (1.5 * half * sum(3)), 1.0, 0.05);
  EXPECT_NEAR(x.aa / (2.5 * half * half * sum(4)), 1.0, 0.02);
  EXPECT_EQ(x.bd, 0.0);
  EXPECT_EQ(x.br, 0.0);
  DeflectionIntegrals cut = over_y;  // whose density does not end at 0
  cut.p1_dp1 = 0.2;
  const PaperIntegrals with = fit_paper_form(*velocities, cut, config).integrals;
  // int of v p^2 of either side: that of p^2 times 3 mm/s and half a length.
  const auto arm = [&](std::size_t s) { return kFromMps + 0.5 * kLengthMps[s]; };
  EXPECT_NEAR(with.cd / (-0.1 * (squares[1] * arm(1) - squares[0] * arm(0))), 1.0, 0.05);
  EXPECT_NEAR(
      with.bd / (0.1 * (squares[1] * arm(1) / kLengthMps[1] + squares[0] * arm(0) / kLengthMps[0])),
      1.0, 0.02);
}

// A deflection whose mean is not zero: the spring's force adds to both sides.
TEST(PaperForm, KnowsTheSpringAtTheMeanDeflection) {
  const auto velocities =
      std::make_unique<VelocityHistogram>(HistogramConfig{.range = {.low = -0.064, .high = 0.064}});
  fill_with(*velocities, 2.0e5, [](double v) { return std::exp(-std::abs(v) / 6.0e-3); });
  const PaperFormConfig config{.beta = 280.0,
                               .input_level = 5.0e-3,
                               .bandwidth_mps = 0.6e-3,
                               .excluded_mps = 3.0e-3,
                               .reach_mps = 0.03};
  const PaperForm form = fit_paper_form(
      *velocities, {.p1_p1 = 2.0, .psi2_p1_p1 = 2.0, .psi4_p1_p1 = 2.0, .y_p1_p1 = 0.4e-3}, config);
  ASSERT_TRUE(form.ok);
  EXPECT_NEAR(form.level_mps2(), 2.5e-3 / 6.0e-3, 2e-3);
  EXPECT_NEAR(form.offset(), -280.0 * 0.2e-3, 2e-3);
  EXPECT_NEAR(form.integrals.br / form.integrals.bb, 0.2e-3, 1e-9);
  EXPECT_NEAR(form.integrals.cr, 0.2e-3 * form.integrals.bc, 1e-9);
}

// As published: ten segments a side, as far as 99 % of the mass, nothing left out.
TEST(PaperForm, ReachesTo99PercentOfTheMass) {
  const auto velocities =
      std::make_unique<VelocityHistogram>(HistogramConfig{.range = {.low = -0.064, .high = 0.064}});
  fill_with(*velocities, 2.0e5, [](double v) { return std::exp(-std::abs(v) / 6.0e-3); });
  for (const double share : {0.5, 0.9, 0.99})
    EXPECT_NEAR(speed_quantile(*velocities, share), -6.0e-3 * std::log(1.0 - share), 0.26e-3);
  EXPECT_EQ(speed_quantile(*velocities, 0.01), velocities->axis().width());
  EXPECT_EQ(speed_quantile(*velocities, 1.1), 0.064);
  const DeflectionIntegrals over_y{.p1_p1 = 1.0, .psi2_p1_p1 = 1.0, .psi4_p1_p1 = 1.0};
  const PaperForm form = fit_paper_form(*velocities, over_y, {.input_level = 5.0e-3});
  EXPECT_TRUE(form.ok);
  EXPECT_EQ(form.used, 10U);
  EXPECT_NEAR(form.segments[1][9].to_mps, speed_quantile(*velocities, 0.99), 1e-12);
  EXPECT_EQ(fit_paper_form(*velocities, over_y, {.input_level = 1.0, .segments = 50}).used, 20U);
  EXPECT_EQ(fit_paper_form(*velocities, over_y, {.input_level = 1.0, .segments = 0}).used, 1U);
  EXPECT_FALSE(fit_paper_form(*velocities, {}, {.input_level = 1.0}).ok) << "no deflection";
  EXPECT_FALSE(fit_paper_form(*velocities, over_y,
                              {.input_level = 1.0, .excluded_mps = 0.03, .reach_mps = 0.03})
                   .ok)
      << "all is left out";
}

TEST(Modulation, FindsAPolynomial) {
  sim::Random random{41, sim::Stream::kTrack};
  Modulation modulation;
  for (int i = 0; i < 400'000; ++i) {
    const double y_mm = random.normal();
    const double psi2 = 1.0 + 0.5 * y_mm + 0.3 * y_mm * y_mm;
    modulation.take(1e-3 * y_mm, std::sqrt(std::max(psi2, 0.0)) * random.normal(), 1.0);
  }
  const auto shape = modulation.shape();  // mean of psi^2: 1.3
  for (const double y_mm : {-1.5, -0.5, 0.0, 1.0, 2.0}) {
    const double expected = (1.0 + 0.5 * y_mm + 0.3 * y_mm * y_mm) / 1.3;
    EXPECT_NEAR(Modulation::at(shape, 1e-3 * y_mm), expected, 0.04 * expected + 0.01);
  }
  EXPECT_EQ(Modulation{}.shape()[0], 1.0);
}

}  // namespace
}  // namespace dampline

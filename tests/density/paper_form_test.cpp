// SPDX-License-Identifier: MIT
#include "dampline/density/paper_form.hpp"

#include <gtest/gtest.h>

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

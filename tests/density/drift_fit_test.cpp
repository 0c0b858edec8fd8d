// SPDX-License-Identifier: MIT
#include "dampline/density/drift_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <tuple>

#include "dampline/basis/columns.hpp"
#include "tests/steps.hpp"

namespace dampline {
namespace {

constexpr double kDriftBeta = 280.0;
constexpr double kDriftRateHz = 300.0;
const DriftBins drift_bins{kDefaultCurveNodesMps};

TEST(DriftBins, HalveTheFirstSegmentAndGoOnWithoutEnd) {
  for (const auto& [speed_mps, bin, place] :
       {std::tuple{0.0, 0U, 0.0}, std::tuple{0.75e-3, 0U, 0.5}, std::tuple{1.5e-3, 1U, 0.0},
        std::tuple{2.25e-3, 1U, 0.5}, std::tuple{3.0e-3, 2U, 0.0}, std::tuple{22.5e-3, 7U, 0.5},
        std::tuple{26.0e-3, 8U, 0.0}, std::tuple{33.0e-3, 8U, 0.5}, std::tuple{54.0e-3, 8U, 2.0}}) {
    EXPECT_EQ(drift_bins.locate(speed_mps), bin) << speed_mps;
    EXPECT_NEAR(drift_bins.place(bin, speed_mps), place, 1e-12) << speed_mps;
  }
}

TEST(DriftPoint, IsTheMomentsOfItsBin) {
  const DriftPoint point = drift_point(drift_bins, -22.5e-3, 2e-3, 0.7, 4.0);
  EXPECT_EQ(point.side, 0U);
  EXPECT_EQ(point.bin, 7U);
  EXPECT_EQ(drift_point(drift_bins, 0.0, 0.0, 0.0, 1.0).side, 1U);
  const DriftMoments& m = point.moments;
  EXPECT_EQ(m.n, 4.0);
  EXPECT_NEAR(m.u, 2.0, 1e-12);
  EXPECT_NEAR(m.uu, 1.0, 1e-12);
  EXPECT_NEAR(m.y, 8e-3, 1e-15);
  EXPECT_NEAR(m.uy, 4e-3, 1e-15);
  EXPECT_NEAR(m.a, 2.8, 1e-12);
  EXPECT_NEAR(m.ua, 1.4, 1e-12);
  DriftSums sums;
  sums.take(point);
  sums.take(point);
  DriftSums more;
  more.add(sums, 0.25);
  more.scale(3.0);
  const DriftMoments& all = more.sides[0][7];
  for (const auto& [sum, one] :
       {std::pair{all.n, m.n}, std::pair{all.u, m.u}, std::pair{all.uu, m.uu},
        std::pair{all.y, m.y}, std::pair{all.uy, m.uy}, std::pair{all.a, m.a},
        std::pair{all.ua, m.ua}})
    EXPECT_NEAR(sum, 1.5 * one, 1e-12);
  EXPECT_NEAR(more.count(), 6.0, 1e-12);
}

/// Samples alike in all bins of both sides but one.
DriftSums held(double samples, std::size_t bin = 0, double other = 0.0, std::size_t side = 0) {
  DriftSums sums;
  for (auto& of_side : sums.sides)
    for (DriftMoments& m : of_side) m.n = samples;
  if (bin > 0) sums.sides[side][bin].n = other;
  return sums;
}

// Sixty samples in each bin, and a hundredth of all from the last one on.
TEST(SupportedSegments, AreThoseThatBothSidesReachWithoutAHole) {
  EXPECT_EQ(supported_segments(held(1000.0)), 8U);
  for (const std::size_t side : {0U, 1U}) {
    EXPECT_EQ(supported_segments(held(1000.0, 5, 60.0, side)), 8U);
    EXPECT_EQ(supported_segments(held(1000.0, 5, 59.0, side)), 4U) << "of segments 1 to 4";
    EXPECT_EQ(supported_segments(held(1000.0, 3, 59.0, side)), 2U);
    EXPECT_EQ(supported_segments(held(1000.0, 2, 59.0, side)), 0U) << "not even two";
    // 17 000 samples beside it.
    EXPECT_EQ(supported_segments(held(1000.0, 8, 172.0, side)), 8U);
    EXPECT_EQ(supported_segments(held(1000.0, 8, 171.0, side)), 7U);
  }
  EXPECT_EQ(supported_segments(DriftSums{}), 0U);
}

using Curve = std::function<double(double)>;

/// A fine grid of velocities with these densities; the deflection follows the velocity.
DriftSums grid(const Curve& density, const Curve& deflection, const Curve& frame_mps2) {
  DriftSums sums;
  constexpr double kStepMps = 1e-5;
  for (const double v : steps(-0.15 + 0.5 * kStepMps, 0.15, kStepMps))
    sums.take(drift_point(drift_bins, v, deflection(v), frame_mps2(v), 1e4 * density(v)));
  return sums;
}

/// A broken line over the first nodes, which goes on as it ends; on either side another.
double broken_line(double v, std::size_t segments) {
  constexpr std::array kSlopes{30.0, -8.0, 12.0, 5.0, -6.0, 3.0, 9.0, -4.0};
  double sum = v < 0.0 ? -0.5 : 0.4;
  double left = 0.0;
  for (std::size_t i = 0; i < segments; ++i) {
    const double right = i + 1 < segments ? kDefaultCurveNodesMps[i] : 1e9;
    const double part = std::min(std::abs(v), right) - left;
    if (part > 0.0) sum += (v < 0.0 ? -0.7 : 1.0) * kSlopes[i] * part;
    left = right;
  }
  return sum;
}

// Where 2 z_b'' + beta y is minus the curve, the fit is the curve at its nodes.
TEST(FitKnownInput, FindsEveryBrokenLineExactly) {
  for (const std::size_t segments : {2U, 3U, 5U, 8U}) {
    const Curve deflection = [](double v) { return 1e-3 * std::sin(400.0 * v); };
    const DriftSums sums = grid(
        [](double v) { return std::exp(-40.0 * std::abs(v)); }, deflection,
        [&](double v) { return -0.5 * (broken_line(v, segments) + kDriftBeta * deflection(v)); });
    const DriftFit fit = fit_known_input(sums, drift_bins, kDriftBeta, segments);
    ASSERT_TRUE(fit.ok);
    EXPECT_EQ(fit.segments, segments);
    for (std::size_t node = 0; node <= segments; ++node) {
      const double speed = node == 0 ? 1e-12 : kDefaultCurveNodesMps[node - 1];
      EXPECT_NEAR(fit.alpha_mps2[0][node], broken_line(-speed, segments), 1e-8) << node;
      EXPECT_NEAR(fit.alpha_mps2[1][node], broken_line(speed, segments), 1e-8) << node;
    }
  }
}

// The first segment knows the level least: there an error of the velocity turns the sign.
TEST(FitKnownInput, LevelAndOffsetAreThoseBeyondTheFirstSegment) {
  const DriftSums sums =
      grid([](double v) { return std::exp(-60.0 * std::abs(v)); }, [](double) { return 0.0; },
           [](double v) {
             if (std::abs(v) < 3.0e-3) return 7.0;
             return -0.5 * ((v < 0.0 ? -0.45 : 0.45) + 0.06);
           });
  const DriftFit fit = fit_known_input(sums, drift_bins, kDriftBeta, 4);
  ASSERT_TRUE(fit.ok);
  EXPECT_NEAR(fit.level_mps2, 0.45, 1e-9);
  EXPECT_NEAR(fit.offset_mps2, 0.06, 1e-9);
  EXPECT_FALSE(fit_known_input(sums, drift_bins, kDriftBeta, 0).ok);
  EXPECT_FALSE(fit_known_input(DriftSums{}, drift_bins, kDriftBeta, 4).ok);
}

/// Of white input of level D the stationary density is exp(-2 / D times the integral of the force).
constexpr double kDriftLevel = 5.0e-3;
double stationary(double v, double level_mps2, double offset_mps2, double per_velocity) {
  const double work = level_mps2 * std::abs(v) + offset_mps2 * v + 0.5 * per_velocity * v * v;
  return std::exp(-2.0 / kDriftLevel * work);
}

TEST(FitWeakForm, FindsTheForceOfAStationaryDensity) {
  for (const auto& [level, offset, viscous] :
       {std::tuple{0.45, 0.0, 0.0}, std::tuple{0.45, 0.05, 0.0}, std::tuple{0.3, 0.0, 4.0}}) {
    for (const std::size_t segments : {3U, 8U}) {
      const DriftSums sums =
          grid([l = level, o = offset, c = viscous](double v) { return stationary(v, l, o, c); },
               [](double) { return 0.0; }, [](double) { return 0.0; });
      const DriftFit fit =
          fit_weak_form(sums, drift_bins, kDriftBeta, kDriftLevel, kDriftRateHz, segments);
      ASSERT_TRUE(fit.ok);
      for (std::size_t node = 0; node <= segments; ++node) {
        const double speed = node == 0 ? 0.0 : kDefaultCurveNodesMps[node - 1];
        EXPECT_NEAR(fit.alpha_mps2[1][node], level + offset + viscous * speed, 0.002) << node;
        EXPECT_NEAR(fit.alpha_mps2[0][node], -level + offset - viscous * speed, 0.002) << node;
      }
      if (viscous > 0.0) continue;
      EXPECT_NEAR(fit.level_mps2, level, 1e-3);
      EXPECT_NEAR(fit.offset_mps2, offset, 1e-3);
    }
  }
}

// A deflection that goes with the velocity takes part of the force, as the spring does.
TEST(FitWeakForm, KnowsTheSpring) {
  constexpr double kSeconds = 0.012;
  const DriftSums sums =
      grid([](double v) { return stationary(v, 0.3, 0.0, 0.7 * kDriftBeta * kSeconds); },
           [](double v) { return 0.7 * kSeconds * v; }, [](double) { return 0.0; });
  const DriftFit fit = fit_weak_form(sums, drift_bins, kDriftBeta, kDriftLevel, kDriftRateHz, 8);
  ASSERT_TRUE(fit.ok);
  EXPECT_NEAR(fit.level_mps2, 0.3, 2e-3);
  for (const double alpha : fit.alpha_mps2[1]) EXPECT_NEAR(alpha, 0.3, 0.01);
  EXPECT_FALSE(fit_weak_form(sums, drift_bins, kDriftBeta, kDriftLevel, kDriftRateHz, 0).ok);
}

// A curve that bends costs: of few samples the nodes lie nearer to a line than of many.
TEST(FitWeakForm, ExpectsLittleBend) {
  const auto bend_of = [](double factor) {
    DriftSums sums = grid(
        [](double v) {
          const double speed = std::abs(v);
          const double work = 0.3 * speed + (speed > 8e-3 ? 30.0 * std::pow(speed - 8e-3, 2) : 0.0);
          return std::exp(-2.0 / kDriftLevel * work);
        },
        [](double) { return 0.0; }, [](double) { return 0.0; });
    sums.scale(factor / sums.count());
    const DriftFit fit = fit_weak_form(sums, drift_bins, kDriftBeta, kDriftLevel, kDriftRateHz, 5);
    EXPECT_TRUE(fit.ok);
    const auto& alpha = fit.alpha_mps2[1];
    return (alpha[5] - alpha[3]) / 6.5e-3 - (alpha[3] - alpha[1]) / 5e-3;
  };
  EXPECT_NEAR(bend_of(1e12), 60.0, 3.0);
  EXPECT_NEAR(bend_of(1e4), 43.0, 4.0) << "half a minute, a tenth of the level a node";
  EXPECT_LT(bend_of(1e3), 20.0);
  EXPECT_GT(bend_of(1e3), 0.0);
}

}  // namespace
}  // namespace dampline

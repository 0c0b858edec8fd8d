// SPDX-License-Identifier: MIT
#include "dampline/damping/curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "dampline/damping/estimator.hpp"
#include "dampline/damping/summary.hpp"

namespace dampline {
namespace {

constexpr double kMassKg = 2.0e4;
constexpr double kStiffness = 140.0;  // per unit of mass
constexpr double kTrueWidthMps = 1.4e-3;
constexpr double kNoise = 0.02;

/// A damping force per unit of mass whose broken line is known: level, then slopes by segment.
struct BrokenLine {
  double level{0.2};
  double width_mps{kTrueWidthMps};
  std::array<double, kCurveSegments> slope{};

  [[nodiscard]] double operator()(double v) const {
    double force = level * std::erf(0.886226925452758 * std::abs(v) / width_mps);
    double left = 0.0;
    for (std::size_t i = 0; i < kCurveSegments; ++i) {
      const double right = i + 1 < kCurveSegments ? kDefaultCurveNodesMps[i] : 1e9;
      if (std::abs(v) > left) force += slope[i] * (std::min(std::abs(v), right) - left);
      left = right;
    }
    return v < 0.0 ? -force : force;
  }
};

/// Statistics of rows of one sample each: no windows, so that the columns are known exactly.
std::unique_ptr<Statistics> statistics_of(const BrokenLine& line, double v_rms_mps,
                                          std::uint64_t seed, double viscous = 0.0,
                                          double noise = kNoise) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal;
  const LawColumns law{kDefaultCurveNodesMps};
  auto out = std::make_unique<Statistics>();
  out->header.curve_nodes_mps = kDefaultCurveNodesMps;
  out->header.entry_count = 25;
  out->header.counts.blocks = 25;
  for (std::uint32_t e = 0; e < out->header.entry_count; ++e) {
    ScaleFactors& entry = out->entries[e];
    for (std::size_t s = 0; s < kScales; ++s) {
      for (int i = 0; i < 400; ++i) {
        const double v = v_rms_mps * normal(random);
        const double y = 0.5e-3 * normal(random);
        GalerkinRow row;
        row << law(v), y, v, line(v) + kStiffness * y + viscous * v + noise * normal(random);
        entry.factor[s].absorb(row);
        entry.rows[s] += 1.0;
        ++out->header.velocity.moving;
        out->header.velocity.sum_squares += v * v;
        if (std::abs(v) < 2e-3) ++out->header.velocity.sticking;
      }
      out->total.factor[s].merge(entry.factor[s]);
      out->total.rows[s] += entry.rows[s];
    }
    entry.blocks = 1;
    ++out->total.blocks;
  }
  return out;
}

Snapshot summary_of(const Statistics& statistics) {
  return summarise(statistics, {.moving_mass_kg = kMassKg});
}

TEST(Curve, FindsABrokenLine) {
  BrokenLine line;
  line.slope = {4.0, 4.0, 3.0, 2.0, 1.0, 0.0, -1.0, -1.0};
  const Snapshot s = summary_of(*statistics_of(line, 14e-3, 1));
  ASSERT_TRUE(s.valid);
  for (std::size_t i = 0; i + 1 < kCurveSegments; ++i) {
    const double truth_n = kMassKg * line(s.curve[i].velocity_mps);
    EXPECT_NEAR(s.curve[i].force_n / truth_n, 1.0, 0.02) << s.curve[i].velocity_mps;
    EXPECT_NEAR(s.curve[i].force_n, truth_n, 4.0 * s.curve[i].std_n + 0.005 * truth_n);
  }
}

TEST(Curve, StatesTheScatterOfItsJumpAtZero) {
  double sum_squares = 0.0;
  constexpr int kSeeds = 8;
  for (int seed = 20; seed < 20 + kSeeds; ++seed) {
    const Snapshot s = summary_of(*statistics_of({}, 14e-3, static_cast<std::uint64_t>(seed)));
    const double off = (s.curve_force_at_zero_n - 0.2 * kMassKg) / s.curve_std_at_zero_n;
    sum_squares += off * off;
    EXPECT_LT(s.curve_std_at_zero_n, 0.1 * s.curve_force_at_zero_n);
  }
  EXPECT_LT(std::sqrt(sum_squares / kSeeds), 2.5);
}

TEST(Curve, IsFlatForPureFriction) {
  const Snapshot s = summary_of(*statistics_of({}, 14e-3, 2));
  for (const CurvePoint& p : s.curve) {
    if (p.velocity_mps < 3.0 * kTrueWidthMps) continue;
    EXPECT_NEAR(p.force_n / (0.2 * kMassKg), 1.0, 0.015) << p.velocity_mps;
  }
}

/// Segments that were never visited stay flat instead of running away.
TEST(Curve, StaysFlatWhereNothingWasVisitedAndSaysThatItDoesNotKnow) {
  const Snapshot s = summary_of(*statistics_of({}, 4e-3, 3));
  ASSERT_TRUE(s.valid);
  EXPECT_NEAR(s.curve.back().force_n / (0.2 * kMassKg), 1.0, 0.25);
  EXPECT_TRUE(std::isfinite(s.curve.back().std_n));
}

TEST(Curve, IsWiderWhereThereAreFewerSamples) {
  const Snapshot s = summary_of(*statistics_of({}, 10e-3, 4));
  EXPECT_GT(s.curve[7].std_n, 2.0 * s.curve[2].std_n);
}

/// A law of 0.2 m/s^2 whose width is the fourth and `shift` of the way from the third to the fifth.
LawProfile<true> known_law(double shift) {
  LawProfile<true> law;
  law.width_index = 3;
  law.fit.theta[LawModel<true>::kCoulomb] = 0.2;
  law.fit.theta[LawModel<true>::kWidthChange] = 0.2 * shift;
  return law;
}

CurveFit fitted(const ScaleFactors& factors, const LawProfile<true>& law) {
  const ScaleFactors* const entry = &factors;
  return CurveFit::make(factors, EntryList{&entry, 1}, law, {true, false, false, false, false},
                        kDefaultCurveNodesMps);
}

// The jump is the law's at its continuous width: g_3 + shift (g_4 - g_2).
TEST(CurveFit, JumpsByTheLawOfItsWidth) {
  for (const double shift : {0.0, 0.2, -0.3}) {
    std::mt19937_64 random{5};
    std::normal_distribution<double> normal;
    ScaleFactors factors;
    for (int i = 0; i < 500; ++i) {
      GalerkinRow row = GalerkinRow::NullaryExpr([&] { return normal(random); });
      row[kTargetColumn] = 0.2 * (row[3] + shift * (row[4] - row[2])) +
                           kStiffness * row[kStiffnessColumn] + 1e-6 * normal(random);
      factors.factor[0].absorb(row);
      factors.rows[0] += 1.0;
    }
    const CurveFit curve = fitted(factors, known_law(shift));
    ASSERT_TRUE(curve.fit.ok);
    EXPECT_NEAR(curve.fit.theta[CurveFit::kJump], 0.2, 1e-6) << shift;
    EXPECT_NEAR(curve.fit.theta[CurveFit::kStiffness], kStiffness, 1e-6) << shift;
  }
}

// Each column by itself, so that a slope is what its rows say, drawn to 0 by the prior: over its
// segment the force changes by 7 % of the level, give or take.
TEST(CurveFit, BendsAsFarAsItsRowsOutweighAPriorOf7PercentASegment) {
  constexpr double kSlope = 5.0;
  ScaleFactors factors;
  const auto add = [&](int column, double regressor, double slope) {
    for (int i = 0; i < 100; ++i) {
      GalerkinRow row = GalerkinRow::Zero();
      row[column] = regressor;
      row[kTargetColumn] = slope * regressor + (i % 2 == 0 ? kNoise : -kNoise);
      factors.factor[0].absorb(row);
      factors.rows[0] += 1.0;
    }
  };
  add(3, 1.0, 0.2);
  add(kStiffnessColumn, 1e-3, kStiffness);
  const auto ramp = [](std::size_t i) { return 1e-4 * static_cast<double>(i + 1); };
  for (std::size_t i = 0; i < kCurveSegments; ++i)
    add(static_cast<int>(kLawWidths + i), ramp(i), kSlope);
  const CurveFit curve = fitted(factors, known_law(0.0));
  ASSERT_TRUE(curve.fit.ok);
  double left_mps = 0.0;
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    const double data = curve.fit.weight[0] * 100.0 * ramp(i) * ramp(i);
    const double prior = std::pow((kDefaultCurveNodesMps[i] - left_mps) / (0.07 * 0.2), 2);
    EXPECT_NEAR(curve.fit.theta[CurveFit::kFirstSlope + static_cast<int>(i)],
                kSlope * data / (data + prior), 1e-4)
        << i;
    left_mps = kDefaultCurveNodesMps[i];
  }
}

// The last segment goes on without end.
TEST(CurveFit, ItsForceIsTheJumpAndWhatTheSegmentsAdd) {
  CurveFit curve;
  curve.fit.theta.setZero();
  curve.covariance.setZero();
  curve.fit.theta[CurveFit::kJump] = 0.2;
  curve.covariance(CurveFit::kJump, CurveFit::kJump) = 1e-4;
  for (int i = 0; i < static_cast<int>(kCurveSegments); ++i) {
    curve.fit.theta[CurveFit::kFirstSlope + i] = 1.0 + i;
    curve.covariance(CurveFit::kFirstSlope + i, CurveFit::kFirstSlope + i) = 0.5 + i;
  }
  for (const double v : {0.0, 1e-3, 3e-3, 4e-3, 20e-3, 40e-3, 0.7}) {
    double force = 0.2;
    double variance = 1e-4;
    double left = 0.0;
    for (std::size_t i = 0; i < kCurveSegments; ++i) {
      const double right = i + 1 < kCurveSegments ? kDefaultCurveNodesMps[i] : 1e9;
      const double part = std::max(std::min(v, right) - left, 0.0);
      force += (1.0 + static_cast<double>(i)) * part;
      variance += (0.5 + static_cast<double>(i)) * part * part;
      left = right;
    }
    EXPECT_NEAR(curve.force(v, kDefaultCurveNodesMps).value, force, 1e-12) << v;
    EXPECT_NEAR(curve.force(v, kDefaultCurveNodesMps).std, std::sqrt(variance), 1e-12) << v;
  }
}

TEST(Summary, FindsLevelStiffnessAndWidth) {
  const Snapshot s = summary_of(*statistics_of({}, 14e-3, 5));
  EXPECT_NEAR(s.coulomb_n.value / (0.2 * kMassKg), 1.0, 0.005);
  EXPECT_NEAR(s.stiffness_npm.value / (kStiffness * kMassKg), 1.0, 0.01);
  EXPECT_NEAR(s.law_width_mps.value / kTrueWidthMps, 1.0, 0.15);
  EXPECT_NEAR(s.velocity_rms_mps, 14e-3, 0.2e-3);
  EXPECT_FALSE(s.std_is_lower_bound);
}

TEST(Summary, FindsAViscousPartAndNoneWhereThereIsNone) {
  const Snapshot with = summary_of(*statistics_of({}, 14e-3, 6, 1.5));
  EXPECT_NEAR(with.viscous_nspm.value / (1.5 * kMassKg), 1.0, 0.06);
  EXPECT_NEAR(with.coulomb_with_viscous_n.value / (0.2 * kMassKg), 1.0, 0.01);
  EXPECT_NEAR(with.stiffness_with_viscous_npm.value / (kStiffness * kMassKg), 1.0, 0.01);
  EXPECT_GT(with.stiffness_with_viscous_npm.std, 0.003 * kStiffness * kMassKg);
  EXPECT_NEAR(with.law_width_with_viscous_mps.value / kTrueWidthMps, 1.0, 0.15);
  EXPECT_LT(with.nmse_with_viscous, with.nmse);
  EXPECT_LT(with.held_out_nmse_with_viscous, with.held_out_nmse);
  const Snapshot without = summary_of(*statistics_of({}, 14e-3, 7));
  EXPECT_LT(std::abs(without.viscous_nspm.value), 3.0 * without.viscous_nspm.std);
}

TEST(Summary, EveryForceScalesWithTheMovingMass) {
  const auto statistics = statistics_of({}, 14e-3, 8);
  const Snapshot one = summarise(*statistics, {.moving_mass_kg = 1.0});
  const Snapshot many = summarise(*statistics, {.moving_mass_kg = 5000.0});
  const auto expect_scaled = [](double a, double b) { EXPECT_NEAR(b / a, 5000.0, 1e-9); };
  expect_scaled(one.coulomb_n.value, many.coulomb_n.value);
  expect_scaled(one.coulomb_n.std, many.coulomb_n.std);
  expect_scaled(one.stiffness_npm.value, many.stiffness_npm.value);
  expect_scaled(one.stiffness_npm.std, many.stiffness_npm.std);
  expect_scaled(one.viscous_nspm.value, many.viscous_nspm.value);
  expect_scaled(one.curve_force_at_zero_n, many.curve_force_at_zero_n);
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    expect_scaled(one.curve[i].force_n, many.curve[i].force_n);
    expect_scaled(one.curve[i].std_n, many.curve[i].std_n);
  }
  EXPECT_EQ(one.law_width_mps.value, many.law_width_mps.value);
  EXPECT_EQ(one.nmse, many.nmse);
}

TEST(Summary, IsNotValidWithoutData) {
  const auto empty = std::make_unique<Statistics>();
  empty->header.curve_nodes_mps = kDefaultCurveNodesMps;
  EXPECT_FALSE(summary_of(*empty).valid);
  const auto few = statistics_of({}, 14e-3, 9);
  few->header.entry_count = 3;
  EXPECT_FALSE(summary_of(*few).valid) << "three blocks do not tell a deviation";
}

TEST(Summary, CallsDeviationsALowerBoundWhereItSticks) {
  const auto statistics = statistics_of({}, 14e-3, 10);
  statistics->header.velocity.sticking = statistics->header.velocity.moving / 2;
  EXPECT_TRUE(summary_of(*statistics).std_is_lower_bound);
}

TEST(Summary, CallsDeviationsALowerBoundWhereTheLawIsWiderThan10Mmps) {
  for (const double width_mps : {8e-3, 11e-3}) {
    const auto statistics = statistics_of({.width_mps = width_mps}, 20e-3, 13, 0.0, 1e-4);
    statistics->header.velocity.sticking = 0;
    const Snapshot s = summary_of(*statistics);
    EXPECT_NEAR(s.law_width_mps.value, width_mps, 0.2e-3);
    EXPECT_EQ(s.std_is_lower_bound, width_mps > 10e-3);
    EXPECT_EQ(s.std_with_viscous_is_lower_bound, width_mps > 10e-3);
  }
}

// What the scatter of the blocks does not show: 0.25 % of the level, 0.3 % of the stiffness, 0.3 %
// of level / v_rms; of a curve 0.25 %, 3 % where it is slow as the width, and 15 % of what the
// width hides.
TEST(Summary, OfAnExactRecordDeviationsAreTheirFloors) {
  const auto statistics = statistics_of({}, 14e-3, 12, 0.0, 1e-7);
  statistics->header.velocity.sticking = 0;
  const Snapshot s = summary_of(*statistics);
  ASSERT_TRUE(s.valid);
  EXPECT_NEAR(s.coulomb_n.std / s.coulomb_n.value, 0.0025, 2e-5);
  EXPECT_NEAR(s.stiffness_npm.std / s.stiffness_npm.value, 0.0030, 2e-5);
  EXPECT_NEAR(s.coulomb_with_viscous_n.std / s.coulomb_with_viscous_n.value, 0.0025, 2e-5);
  EXPECT_NEAR(s.viscous_nspm.std * s.velocity_rms_mps / s.coulomb_with_viscous_n.value, 0.0030,
              2e-5);
  EXPECT_NEAR(s.curve_std_at_zero_n / s.curve_force_at_zero_n, 0.0025, 2e-5);
  for (const CurvePoint& p : s.curve) {
    const double width = s.law_width_with_viscous_mps.value;
    const double near = width / p.velocity_mps;
    const double unseen = 1.0 - std::erf(0.886226925452758 / near);
    const double floor = std::hypot(0.0025, 0.03 * near, 0.15 * unseen);
    EXPECT_NEAR(p.std_n / p.force_n / floor, 1.0, 0.02) << p.velocity_mps;
  }
}

TEST(Summary, TheHeldOutErrorIsTheNoisesShare) {
  const Snapshot s = summary_of(*statistics_of({}, 14e-3, 11));
  EXPECT_GE(s.held_out_nmse, s.nmse);
  // Signal: 0.2^2 less what the smooth sign loses near zero, and (140 * 0.5e-3)^2.
  EXPECT_NEAR(s.held_out_nmse, kNoise * kNoise / (0.038 + 0.0049 + kNoise * kNoise), 1e-3);
}

}  // namespace
}  // namespace dampline

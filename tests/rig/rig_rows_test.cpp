// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "dampline/rig/columns.hpp"
#include "dampline/rig/fit.hpp"
#include "dampline/rig/motion.hpp"
#include "dampline/rig/resonance.hpp"

namespace dampline {
namespace {

namespace column = rig::column;

rig::Config row_config() {
  rig::Config config;
  config.sample_rate_hz = 1000.0;
  config.corner_hz = 40.0;  // 0.477 / 40 Hz: 12 samples, and two
  config.still_mps = 0.02;
  return config;
}

/// A motion of two tones, a force that has nothing to do with it.
rig::Motion two_tones(std::int64_t tick) {
  const auto velocity = [](double t) {
    return 0.08 * std::cos(31.0 * t) + 0.05 * std::cos(97.0 * t + 1.0);
  };
  const double t = 1e-3 * static_cast<double>(tick);
  return {.tick = tick,
          .deflection_m = 0.003 * std::sin(31.0 * t) + 0.001,
          .velocity_before_mps = velocity(t - 1e-3),
          .velocity_mps = velocity(t),
          .velocity_after_mps = velocity(t + 1e-3),
          .force_n = 50.0 + 7.0 * std::sin(13.0 * t)};
}

// Each column is the sum of the test function, or of its derivative, times the instants' values.
TEST(RigRows, AreTheTestFunctionAgainstEveryColumn) {
  const rig::Config config = row_config();
  rig::Rows rows{config};
  const rig::Regressors regressors{config};
  const rig::TestFunction psi{rows.half(), 1e-3};
  ASSERT_EQ(rows.half(), 14);
  std::vector<std::int64_t> centres;
  for (std::int64_t tick = 0; tick < 600; ++tick) {
    rig::Row out;
    if (!rows.update(two_tones(tick), out)) continue;
    centres.push_back(out.centre_tick);
    rig::Block::Row sum = rig::Block::Row::Zero();
    double still = 0.0;
    for (int j = -psi.half(); j <= psi.half(); ++j) {
      const rig::Motion motion = two_tones(out.centre_tick + j);
      rig::Block::Row now = rig::Block::Row::Zero();
      regressors.fill(motion, now);
      const auto at = psi.at(j);
      sum += at.psi * now;
      sum[column::kInertia] += at.second * motion.deflection_m;
      sum[column::kStiffness] += at.psi * motion.deflection_m;
      sum[column::kViscous] -= at.first * motion.deflection_m;
      sum[column::kForce] += at.psi * motion.force_n;
      if (std::abs(motion.velocity_mps) < 0.02) still += at.psi;
    }
    EXPECT_LT((out.row - sum).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_NEAR(out.row[column::kOne], 1.0, 1e-12);
    EXPECT_NEAR(out.still_share, still, 1e-12);
  }
  ASSERT_GT(centres.size(), 70U);
  EXPECT_EQ(centres.front(), 14) << "as soon as a test function has passed";
  for (std::size_t i = 1; i < centres.size(); ++i)
    EXPECT_EQ(centres[i] - centres[i - 1], 7) << "every half of a half support";
}

TEST(RigRows, DropOpenWindowsAtAReset) {
  rig::Rows rows{row_config()};
  rig::Row out;
  for (std::int64_t tick = 0; tick < 100; ++tick) rows.update(two_tones(tick), out);
  rows.reset();
  for (std::int64_t tick = 0; tick < 28; ++tick)
    EXPECT_FALSE(rows.update(two_tones(1000 + tick), out)) << tick;
  ASSERT_TRUE(rows.update(two_tones(1028), out));
  EXPECT_EQ(out.centre_tick, 1014);
  EXPECT_NEAR(out.row[column::kOne], 1.0, 1e-12) << "nothing of before";
}

TEST(RigRegressors, OfABranchHaveItsFullSignAndRamps) {
  const rig::Config config;  // segments of 12.5 mm/s
  for (const bool positive : {true, false}) {
    rig::Block::Row row = rig::Block::Row::Zero();
    rig::Regressors{config}.fill_branch(positive, 0.03, row);
    const double sign = positive ? 1.0 : -1.0;
    EXPECT_EQ(row[column::kSign], sign);
    EXPECT_EQ(row[column::kOne], 1.0);
    const int own = positive ? column::kRampPositive : column::kRampNegative;
    const int other = positive ? column::kRampNegative : column::kRampPositive;
    for (int i = 0; i < static_cast<int>(kCurveSegments); ++i) {
      EXPECT_NEAR(row[own + i], sign * (i < 2 ? 0.0125 : i == 2 ? 0.005 : 0.0), 1e-15) << i;
      EXPECT_EQ(row[other + i], 0.0);
    }
    EXPECT_EQ(row[column::kInertia], 0.0);
    EXPECT_EQ(row[column::kForce], 0.0);
  }
  const auto beyond = rig::ramps(0.25, config.curve_nodes_mps);
  EXPECT_NEAR(beyond[7], 0.25 - 0.0875, 1e-15) << "the last segment has no end";
}

TEST(RigDerivative, IsExactForStraightLinesAndKnowsItsNoise) {
  for (const int half : {1, 2, 7, 32}) {
    const rig::DerivativeWindow window{half, 0.01};
    EXPECT_EQ(window.half_width(), half);
    double slope = 0.0, squares = 0.0;
    for (int j = 1; j <= half; ++j) {
      const double u = static_cast<double>(j) / (half + 1);
      EXPECT_NEAR(window.weight(j) / window.weight(1),
                  j * std::pow((1.0 - u * u) / (1.0 - 1.0 / std::pow(half + 1, 2)), 2), 1e-12);
      slope += window.weight(j) * 2.0 * j * 0.01;
      squares += 2.0 * window.weight(j) * window.weight(j);
    }
    EXPECT_NEAR(slope, 1.0, 1e-12);
    EXPECT_NEAR(window.noise_gain(), std::sqrt(squares), 1e-9);
  }
  EXPECT_EQ((rig::DerivativeWindow{0, 1.0}.half_width()), 1);
  EXPECT_EQ((rig::DerivativeWindow{40, 1.0}.half_width()), 32);
}

TEST(RigMotion, IsThatOfItsLatencyAgo) {
  rig::Config config = row_config();
  config.velocity_half_width = 3;
  for (const bool measured : {false, true}) {
    config.velocity_measured = measured;
    rig::MotionEstimator estimator{config};
    EXPECT_EQ(estimator.latency_samples(), 4);
    int got = 0;
    for (std::int64_t tick = 0; tick < 40; ++tick) {
      if (tick == 20) estimator.reset();
      const auto n = static_cast<double>(tick);
      rig::Motion motion;
      const bool has = estimator.update(
          {.tick = tick, .deflection_m = 1e-5 * n * n, .velocity_mps = 3.0 + n, .force_n = 7.0 * n},
          motion);
      EXPECT_EQ(has, tick % 20 >= 8) << tick << ": nine samples make one";
      if (!has) continue;
      ++got;
      const double at = n - 4.0;
      EXPECT_EQ(motion.tick, tick - 4);
      EXPECT_NEAR(motion.deflection_m, 1e-5 * at * at, 1e-15);
      EXPECT_NEAR(motion.force_n, 7.0 * at, 1e-12);
      const auto velocity = [&](double k) { return measured ? 3.0 + k : 2e-5 * k * 1000.0; };
      EXPECT_NEAR(motion.velocity_before_mps, velocity(at - 1.0), 1e-9);
      EXPECT_NEAR(motion.velocity_mps, velocity(at), 1e-9);
      EXPECT_NEAR(motion.velocity_after_mps, velocity(at + 1.0), 1e-9);
    }
    EXPECT_EQ(got, 24);
  }
}

std::vector<rig::Parameter> parameters_of(const rig::Model& model) {
  std::vector<rig::Parameter> out;
  for (int j = 0; j < model.size(); ++j) out.push_back(model.parameter(j));
  return out;
}

// A row of steady motion on a branch: what each unknown multiplies.
TEST(RigModel, IsTheTermsThatWereAskedFor) {
  using rig::Branches;
  using P = rig::Parameter;
  const rig::Model common{{true, true, Branches::kCommon, Branches::kCommon, true}};
  EXPECT_EQ(parameters_of(common),
            (std::vector{P::kMovingMass, P::kStiffness, P::kCoulomb, P::kViscous, P::kOffset}));
  const rig::Model separate{{false, false, Branches::kSeparate, Branches::kSeparate, false}};
  EXPECT_EQ(parameters_of(separate), (std::vector{P::kCoulombPositive, P::kCoulombNegative,
                                                  P::kViscousPositive, P::kViscousNegative}));
  EXPECT_EQ((rig::Model{{false, false, Branches::kNone, Branches::kNone, false}}.size()), 0);
  const rig::Config config;
  for (const bool positive : {true, false}) {
    rig::Block::Row row = rig::Block::Row::Zero();
    rig::Regressors{config}.fill_branch(positive, 0.03, row);
    row[column::kInertia] = 11.0;
    row[column::kStiffness] = 12.0;
    row[column::kViscous] = 13.0;
    const double sign = positive ? 1.0 : -1.0;
    EXPECT_EQ(common.value(0, row), 11.0);
    EXPECT_EQ(common.value(1, row), 12.0);
    EXPECT_EQ(common.value(2, row), sign);
    EXPECT_EQ(common.value(3, row), 13.0);
    EXPECT_EQ(common.value(4, row), 1.0);
    EXPECT_EQ(separate.value(0, row), positive ? 1.0 : 0.0);
    EXPECT_EQ(separate.value(1, row), positive ? 0.0 : -1.0);
    EXPECT_NEAR(separate.value(2, row), positive ? 0.03 : 0.0, 1e-15);
    EXPECT_NEAR(separate.value(3, row), positive ? 0.0 : -0.03, 1e-15);
    const rig::Model curve =
        rig::Model::curve({true, false, Branches::kNone, Branches::kNone, false});
    ASSERT_EQ(curve.size(), 3 + 16);
    EXPECT_EQ(curve.parameter(3), P::kSlope);
    double ramps = 0.0;
    for (int j = 3; j < curve.size(); ++j) ramps += curve.value(j, row);
    EXPECT_NEAR(ramps, sign * 0.03, 1e-15);
  }
  rig::Model less = common;
  less.remove(1);
  EXPECT_EQ(parameters_of(less),
            (std::vector{P::kMovingMass, P::kCoulomb, P::kViscous, P::kOffset}));
  EXPECT_EQ(less.column(1)[column::kSign], 1.0);
}

TEST(RigBlockStore, HoldsARecordOfAnyLengthIn128Blocks) {
  const auto store = std::make_unique<rig::BlockStore>(10);
  double ones = 0.0;
  for (std::int64_t tick = 0; tick < 10'000; ++tick) {
    rig::Block::Row row = rig::Block::Row::Zero();
    row[column::kOne] = 1.0;
    store->absorb(tick, row);
    ones += 1.0;
    ASSERT_EQ(store->size(), static_cast<std::size_t>(tick / store->block_samples()) + 1);
    if (tick == 1279) {
      EXPECT_EQ(store->block_samples(), 10);
    }
    if (tick == 1280) {
      EXPECT_EQ(store->block_samples(), 20);
    }
  }
  EXPECT_EQ(store->block_samples(), 80);
  double sum = 0.0;
  for (std::size_t b = 0; b < store->size(); ++b)
    sum += std::pow(store->block(b).column_norm(column::kOne), 2);
  EXPECT_NEAR(sum, ones, 1e-6);
}

/// Blocks of rows of f = 40 sign + 9000 x + noise; the other columns hold noise or nothing.
struct Synthetic {
  explicit Synthetic(std::uint64_t seed, double noise = 1.0) {
    std::mt19937_64 random{seed};
    std::normal_distribution<double> normal;
    for (std::int64_t tick = 0; tick < 1000; ++tick) {
      rig::Block::Row row = rig::Block::Row::Zero();
      row[column::kSign] = tick / 7 % 2 == 0 ? 1.0 : -1.0;
      row[column::kOne] = 1.0;
      row[column::kStiffness] = 0.003 * normal(random);
      row[column::kForce] =
          40.0 * row[column::kSign] + 9000.0 * row[column::kStiffness] + noise * normal(random);
      store->absorb(tick, row);
      rows.push_back(row);
    }
  }
  std::unique_ptr<rig::BlockStore> store{std::make_unique<rig::BlockStore>(10)};
  std::vector<rig::Block::Row> rows;
};
constexpr rig::Terms kCoulombAndSpring{false, true, rig::Branches::kNone, rig::Branches::kCommon,
                                       false};

TEST(RigSolve, IsLeastSquaresWithItsErrors) {
  const Synthetic data{1};
  const rig::Solution out = solve(*data.store, rig::Model{kCoulombAndSpring});
  ASSERT_TRUE(out.valid);
  ASSERT_EQ(out.model.size(), 2);
  EXPECT_EQ(out.blocks, 100U);
  Eigen::Matrix2d gram = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  double sum = 0.0, squares = 0.0;
  for (const rig::Block::Row& row : data.rows) {
    const Eigen::Vector2d x{row[column::kStiffness], row[column::kSign]};
    gram += x * x.transpose();
    right += x * row[column::kForce];
    sum += row[column::kForce];
    squares += row[column::kForce] * row[column::kForce];
  }
  const Eigen::Vector2d theta = gram.inverse() * right;
  EXPECT_NEAR(out.theta[0], theta[0], 1e-6);
  EXPECT_NEAR(out.theta[1], theta[1], 1e-9);
  const double left = squares - theta.dot(right);
  const double variance = squares - sum * sum / 1000.0;
  EXPECT_NEAR(out.nmse, left / variance, 1e-9);
  EXPECT_NEAR(out.residual_n, std::sqrt(left / 1000.0), 1e-9);
  EXPECT_NEAR(out.held_out_nmse / out.nmse, 1.0 + 2.0 * 2.0 / 1000.0 * 1.25, 0.004);
  for (const auto& part : out.theta_without) EXPECT_NE(part[1], out.theta[1]);
}

// Of independent noise: that of least squares, times (1 + 2.5 / 97)^2 100 / 98.
TEST(RigSolve, StatesTheVarianceOfItsUnknowns) {
  Eigen::Matrix2d stated = Eigen::Matrix2d::Zero();
  double squares = 0.0;
  constexpr int kRecords = 40;
  for (std::uint64_t seed = 1; seed <= kRecords; ++seed) {
    const Synthetic data{seed};
    const rig::Solution out = solve(*data.store, rig::Model{kCoulombAndSpring});
    stated += out.covariance.topLeftCorner<2, 2>() / kRecords;
    squares += std::pow(out.theta[1] - 40.0, 2) / kRecords;
    rig::ModelInformation::Vector weights{};
    weights[1] = 3.0;
    EXPECT_NEAR(out.std_of(weights), 3.0 * std::sqrt(out.covariance(1, 1)), 1e-12);
  }
  const double factor = std::pow(1.0 + 2.5 / 97.0, 2) * 100.0 / 98.0;
  EXPECT_NEAR(stated(1, 1) / (factor / 1000.0), 1.0, 0.12);
  EXPECT_NEAR(stated(0, 0) / (factor / 1000.0 / 9e-6), 1.0, 0.12);
  EXPECT_NEAR(squares / stated(1, 1), 1.0, 0.5);
}

TEST(RigSolve, LeavesOutWhatNothingShows) {
  const Synthetic data{2};
  rig::Terms terms = kCoulombAndSpring;
  terms.inertia = true;
  terms.viscous = rig::Branches::kCommon;
  const rig::Solution out = solve(*data.store, rig::Model{terms});
  ASSERT_TRUE(out.valid);
  EXPECT_EQ(parameters_of(out.model),
            (std::vector{rig::Parameter::kStiffness, rig::Parameter::kCoulomb}));
  EXPECT_NEAR(out.theta[1], 40.0, 0.2);
  rig::Terms none{true, false, rig::Branches::kNone, rig::Branches::kNone, false};
  EXPECT_FALSE(solve(*data.store, rig::Model{none}).valid);
  EXPECT_FALSE(solve(rig::BlockStore{10}, rig::Model{kCoulombAndSpring}).valid);
}

// A step from rest: p = 1 - e^(-D w t) (cos w_d t + D w / w_d sin w_d t).
TEST(RigResonance, IsExactForInputThatIsStraightBetweenSamples) {
  constexpr double kStepS = 0.004;
  for (const auto& [hz, damping] :
       {std::pair{3.0, 0.05}, std::pair{17.0, 0.3}, std::pair{90.0, 0.02}}) {
    const double w = 2.0 * std::acos(-1.0) * hz;
    const double wd = w * std::sqrt(1.0 - damping * damping);
    const auto step = [&, d = damping](double t) {
      return 1.0 - std::exp(-d * w * t) * (std::cos(wd * t) + d * w / wd * std::sin(wd * t));
    };
    const auto rate = [&, d = damping](double t) {  // over w
      return std::exp(-d * w * t) * w / wd * std::sin(wd * t);
    };
    rig::Resonance rises{{hz, damping}, kStepS};
    rig::Resonance ramps{{hz, damping}, kStepS};
    rises.start(0.0);
    ramps.start(0.0);
    for (int n = 0; n < 300; ++n) {
      const double t = kStepS * (n + 1);
      rises.advance(1.0, 1.0);
      ramps.advance(kStepS * n, t);
      ASSERT_NEAR(rises.value(), step(t), 1e-9) << hz;
      ASSERT_NEAR(rises.rate_over_w(), rate(t), 1e-9) << hz;
      // The ramp's response is the integral of the step's: t - 2 D / w + (p' + 2 D w p - ...) /
      // w^2.
      const double after = t - (rate(t) / w + 2.0 * damping / w * step(t));
      ASSERT_NEAR(ramps.value(), after, 1e-9) << hz;
    }
    rig::Resonance rests{{hz, damping}, kStepS};
    rests.start(0.7);
    for (int n = 0; n < 100; ++n) rests.advance(0.7, 0.7);
    EXPECT_NEAR(rests.value(), 0.7, 1e-9) << "at rest on what it began with";
  }
}

}  // namespace
}  // namespace dampline

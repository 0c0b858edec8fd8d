// SPDX-License-Identifier: MIT
#include "published/wavelet/model_selection.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/published/prescribed_motion.hpp"

namespace dampline {
namespace {

using Seven = SingleModel<
    TermList<Viscous, Spring, Power<2, 0>, Power<1, 1>, CubicSpring, VanDerPolDamper, Power<0, 3>>>;
using Selection = ModelSelection<Seven>;
constexpr double kSelectionStepS = 0.05;
constexpr Selection::Mask kDuffing{true, true, false, false, true, false, false};
constexpr Selection::Mask kLinear{true, true, false, false, false, false, false};

/// A Duffing oscillator (m 2, c 0.1, k 1, k3 0.3) whose force is measured with an error.
Selection duffing(double noise_n, int samples, std::uint64_t seed) {
  auto rows =
      MotionRows<D16, Seven>::make({.step_s = kSelectionStepS, .mass_kg = {2.0}}, Seven{}).value();
  const PrescribedMotion motion = two_tones();
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal{0.0, 1.0};
  Selection selection;
  MotionRow<Seven> row;
  for (int i = 0; i < samples; ++i) {
    const double t = i * kSelectionStepS;
    const double x = motion.x(t);
    const double f = 2.0 * motion.a(t) + 0.1 * motion.v(t) + x + 0.3 * x * x * x;
    const double measured = f + noise_n * normal(random);
    if (rows.push({.deflection_m = {x}, .force_n = {measured}}, row)) selection.absorb(row, {2.0});
  }
  return selection;
}

TEST(ModelSelection, KeepsTheTermsThatAreThere) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto chosen = duffing(0.02, 4000, seed).choose();
    ASSERT_TRUE(chosen.valid);
    EXPECT_EQ(chosen.terms, kDuffing) << seed;
    EXPECT_NEAR(chosen.theta[4], 0.3, 5.0 * chosen.deviation[4]);
  }
}

TEST(ModelSelection, TellsSpuriousTermsFromTrueOnes) {
  const auto full = duffing(0.02, 4000, 3).fit(Selection::everything());
  ASSERT_TRUE(full.valid);
  for (const int i : {0, 1, 4}) EXPECT_GT(std::abs(full.t_ratio[i]), 10.0) << i;
  for (const int i : {2, 3, 5, 6}) EXPECT_LT(std::abs(full.t_ratio[i]), 4.0) << i;
}

TEST(ModelSelection, StatesDeviationsThatHold) {
  // Over 400 records, the error in units of the stated deviation has variance one.
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const auto fit = duffing(0.05, 1500, seed).fit(kDuffing);
    sum += std::pow((fit.theta[4] - 0.3) / fit.deviation[4], 2);
  }
  EXPECT_NEAR(sum / 400.0, 1.2, 0.3);  // sixteen blocks: Student's t with 15 degrees of freedom
}

// Equation 35 by hand: white noise in the force is all that the true model leaves.
TEST(ModelSelection, MseIsTheNoisesShareOfTheAcceleration) {
  const auto fit = duffing(0.1, 8000, 5).fit(kDuffing);
  double squares = 0.0;
  double mean = 0.0;
  for (int i = 0; i < 8000; ++i) {
    const double a = two_tones().a(i * kSelectionStepS);
    mean += a / 8000.0;
    squares += a * a / 8000.0;
  }
  const double expected = 100.0 * std::pow(0.1 / 2.0, 2) / (squares - mean * mean);
  EXPECT_NEAR(fit.mse_percent[0] / expected, 1.0, 0.05);
  EXPECT_NEAR(fit.held_out_mse_percent[0] / expected, 1.0, 0.05);
}

TEST(ModelSelection, InSampleErrorCannotRejectATermButHeldOutErrorCan) {
  int rejected = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Selection selection = duffing(0.05, 1500, seed);
    const auto is_true = selection.fit(kDuffing);
    const auto full = selection.fit(Selection::everything());
    const auto linear = selection.fit(kLinear);
    EXPECT_LT(full.mse_percent[0], is_true.mse_percent[0]);
    EXPECT_GT(linear.mse_percent[0], 10.0 * is_true.mse_percent[0]);
    rejected += full.held_out_mse_percent[0] > is_true.held_out_mse_percent[0] ? 1 : 0;
  }
  EXPECT_GE(rejected, 9);
}

TEST(ModelSelection, ExactDataLeaveNothing) {
  const auto fit = duffing(0.0, 4000, 1).fit(kDuffing);
  EXPECT_LT(fit.mse_percent[0], 1e-18);
}

TEST(ModelSelection, IsNotValidOnTooLittle) {
  EXPECT_FALSE(duffing(0.0, 300, 1).fit(kDuffing).valid);
}

TEST(ModelBlocks, JoinTwoByTwoWithoutLosingAnything) {
  ModelBlocks<1, 1> blocks{2};
  Information<2>::Row row;
  double squares = 0.0;
  for (int i = 0; i < 1000; ++i) {
    row << 1.0 + i % 7, 3.0 * (1.0 + i % 7);
    squares += row[0] * row[0];
    blocks.begin_instant();
    blocks.absorb(0, row);
  }
  EXPECT_LE(blocks.count(), 16U);
  EXPECT_GE(blocks.count(), 8U);
  const auto sum = blocks.sum({true}, [](std::size_t) { return true; });
  EXPECT_NEAR(sum.at(0, 0) * sum.at(0, 0), squares, 1e-9 * squares);
  Eigen::Matrix<double, 1, 1> theta;
  ASSERT_TRUE((ModelBlocks<1, 1>::solve(sum, {true}, theta)));
  EXPECT_NEAR(theta[0], 3.0, 1e-13);
  EXPECT_FALSE((ModelBlocks<1, 1>::solve({}, {true}, theta)));
}

}  // namespace
}  // namespace dampline

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "published/wavelet/estimates.hpp"
#include "published/wavelet/motion_rows.hpp"
#include "tests/dense.hpp"
#include "tests/published/prescribed_motion.hpp"

namespace dampline {
namespace {

using Duffing = SingleModel<TermList<Viscous, Spring, CubicSpring>>;
using Row = Information<4>::Row;

constexpr double kEstimatorStepS = 0.05;

/// Rows of a Duffing oscillator (c 0.04, k 1, k3 0.3); from sample `drop` on, k is 20 % less.
std::vector<Row> duffing_rows(int samples, int drop) {
  auto rows =
      MotionRows<D12, Duffing>::make({.step_s = kEstimatorStepS, .mass_kg = {1.0}}, Duffing{})
          .value();
  const PrescribedMotion motion = two_tones();
  std::vector<Row> out;
  MotionRow<Duffing> row;
  for (int i = 0; i < samples; ++i) {
    const double t = i * kEstimatorStepS;
    const double x = motion.x(t);
    const double k = i < drop ? 1.0 : 0.8;
    const double f = motion.a(t) + 0.04 * motion.v(t) + k * x + 0.3 * x * x * x;
    if (rows.push({.deflection_m = {x}, .force_n = {f}}, row)) out.push_back(row.equation(0));
  }
  return out;
}

Eigen::Vector3d batch(const std::vector<Row>& rows, std::size_t first, std::size_t last) {
  Eigen::MatrixXd a(static_cast<Eigen::Index>(last - first), 4);
  for (std::size_t i = first; i < last; ++i) {
    a.row(static_cast<Eigen::Index>(i - first)) = rows[i].transpose();
  }
  return test::least_squares(a.leftCols(3), a.col(3));
}

double difference(const Eigen::Vector3d& theta, const Eigen::Vector3d& truth) {
  return (theta - truth).cwiseQuotient(truth).lpNorm<Eigen::Infinity>();
}

TEST(RecursiveEstimate, EqualsTheBatchSolution) {
  const std::vector<Row> rows = duffing_rows(10'000, 10'000);
  RecursiveEstimate<3> recursive;
  for (const Row& row : rows) recursive.absorb(row);
  ASSERT_TRUE(recursive.update());
  EXPECT_LT(difference(recursive.latest().theta, batch(rows, 0, rows.size())), 1e-12);
}

TEST(RecursiveEstimate, StatesDeviationAndResidual) {
  std::vector<Row> rows = duffing_rows(4000, 4000);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i][3] +=
        static_cast<double>(i * 2654435761U % 1000U) / 999.0 - 0.5;  // uniform: rms 1 / sqrt(12)
  }
  RecursiveEstimate<3> recursive;
  for (const Row& row : rows) recursive.absorb(row);
  ASSERT_TRUE(recursive.update());
  const auto& latest = recursive.latest();
  EXPECT_NEAR(latest.residual_rms, 1.0 / std::sqrt(12.0), 0.01);
  const Eigen::Vector3d truth{0.04, 1.0, 0.3};
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(latest.theta[i] - truth[i]), 4.0 * latest.deviation[i]) << i;
  }
  EXPECT_LT(latest.deviation[1], 0.02);
}

TEST(RecursiveEstimate, ForgetsWithItsTimeConstant) {
  RecursiveEstimate<1> recursive{100.0};
  Information<2>::Row row;
  row << 1.0, 0.0;
  for (int i = 0; i < 5000; ++i) recursive.absorb(row);
  row[1] = 1.0;
  for (int i = 0; i < 100; ++i) recursive.absorb(row);
  ASSERT_TRUE(recursive.update());
  EXPECT_NEAR(recursive.latest().theta[0], 1.0 - std::exp(-1.0), 1e-9);
  EXPECT_NEAR(recursive.rows(), 1.0 / (1.0 - std::exp(-0.01)), 1e-6);
}

TEST(RecursiveEstimate, IsTheSameWhetherAskedAfterEveryRowOrAtTheEnd) {
  const std::vector<Row> rows = duffing_rows(1003, 1003);  // not a whole number of panels
  RecursiveEstimate<3> often{200.0};
  RecursiveEstimate<3> once{200.0};
  for (const Row& row : rows) {
    often.absorb(row);
    once.absorb(row);
    static_cast<void>(often.information());
  }
  ASSERT_TRUE(often.update());
  ASSERT_TRUE(once.update());
  EXPECT_LT(difference(once.latest().theta, often.latest().theta), 1e-12);
  EXPECT_NEAR(once.latest().residual_rms, often.latest().residual_rms, 1e-12);
  EXPECT_NEAR(once.information().at(0, 0), often.information().at(0, 0), 1e-10);
}

TEST(RecursiveEstimate, HoldsWhereTheRowsDoNotDetermineIt) {
  RecursiveEstimate<3> recursive;
  Row row;
  row << 1.0, 2.0, 3.0, 4.0;  // always the same direction
  for (int i = 0; i < 100; ++i) recursive.absorb(row);
  EXPECT_FALSE(recursive.update());
  EXPECT_FALSE(recursive.latest().valid);
  RecursiveEstimate<3> few;
  for (const Row& good : duffing_rows(20 + 15, 100)) few.absorb(good);  // five rows an unknown
  EXPECT_FALSE(few.update());
}

TEST(FactorRing, EqualsTheBatchSolutionOfItsWindowAtAnyMoment) {
  const std::vector<Row> rows = duffing_rows(3000, 3000);
  FactorRing<3, 4> ring{8};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ring.absorb(rows[i]);
    if (!ring.update()) continue;
    const auto held = static_cast<std::size_t>(ring.rows());
    ASSERT_GE(held, i < 31 ? i + 1 : 25U);
    ASSERT_LE(held, 32U);
    ASSERT_LT(difference(ring.latest().theta, batch(rows, i + 1 - held, i + 1)), 1e-10) << i;
  }
  EXPECT_TRUE(ring.latest().valid);
}

// The window is 1.6 s of a motion whose periods are 6.3 and 3.7 s.
TEST(FactorRing, FindsAStiffnessThatDroppedWithinOneWindow) {
  const int drop = 1500;
  const std::vector<Row> rows = duffing_rows(3000, drop);
  FactorRing<3, 4> ring{8};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ring.absorb(rows[i]);
    static_cast<void>(ring.update());
    const auto sample = static_cast<int>(i) + D12::kReach;
    if (sample == drop - 1) {
      EXPECT_NEAR(ring.latest().theta[1], 1.0, 1e-6);
    }
    if (sample >= drop + 32) {
      ASSERT_NEAR(ring.latest().theta[1], 0.8, 1e-6) << sample;
    }
  }
}

TEST(FactorRing, HoldsOverWindowsThatDoNotDetermineIt) {
  FactorRing<1, 2> ring{8};
  Information<2>::Row row;
  row << 1.0, 3.0;
  for (int i = 0; i < 16; ++i) ring.absorb(row);
  ASSERT_TRUE(ring.update());
  row.setZero();
  for (int i = 0; i < 32; ++i) ring.absorb(row);
  EXPECT_FALSE(ring.update());
  EXPECT_DOUBLE_EQ(ring.latest().theta[0], 3.0);
}

TEST(SequentialWindows, HaveMeanAndVariationOfTheirEstimates) {
  SequentialWindows<1> windows{2};
  const auto window = [&](double value) {
    Information<2>::Row row;
    row << 1.0, value;
    EXPECT_EQ(windows.absorb(row), WindowEvent::kOpen);
    return windows.absorb(row);
  };
  EXPECT_EQ(window(-2.0), WindowEvent::kSolved);
  EXPECT_EQ(window(-4.0), WindowEvent::kSolved);
  EXPECT_EQ(window(-6.0), WindowEvent::kSolved);
  EXPECT_DOUBLE_EQ(windows.scatter().mean()[0], -4.0);
  EXPECT_DOUBLE_EQ(windows.scatter().deviation()[0], 2.0);
  EXPECT_DOUBLE_EQ(windows.scatter().cov()[0], 0.5);
  EXPECT_DOUBLE_EQ(windows.latest().theta[0], -6.0);
}

TEST(SequentialWindows, CountWhatTheyHeld) {
  SequentialWindows<2> windows{4};
  Information<3>::Row row;
  row << 1.0, 2.0, 3.0;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(windows.absorb(row), WindowEvent::kOpen);
  EXPECT_EQ(windows.absorb(row), WindowEvent::kHeld);
  EXPECT_EQ(windows.held(), 1);
  EXPECT_EQ(windows.scatter().count(), 0);
}

TEST(SequentialWindows, Of32RowsFindTheOscillator) {
  SequentialWindows<3> windows;
  for (const Row& row : duffing_rows(3220, 4000)) static_cast<void>(windows.absorb(row));
  EXPECT_EQ(windows.scatter().count(), 100);
  EXPECT_LT(difference(windows.scatter().mean(), {0.04, 1.0, 0.3}), 1e-7);
  EXPECT_LT(windows.scatter().cov().maxCoeff(), 1e-6);
}

// What a processor without double precision would get.
TEST(SinglePrecision, KeepsFourDigitsOverAWholeRunAndThreeInAWindow) {
  const std::vector<Row> rows = duffing_rows(10'000, 10'000);
  RecursiveEstimate<3, float> recursive;
  FactorRing<3, 4, float> ring{8, {.tolerance = 1e-5}};
  double worst = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Matrix<float, 4, 1> row = rows[i].cast<float>();
    recursive.absorb(row);
    ring.absorb(row);
    if (i < 100 || !ring.update()) continue;
    worst = std::max(worst,
                     difference(ring.latest().theta.cast<double>(),
                                batch(rows, i + 1 - static_cast<std::size_t>(ring.rows()), i + 1)));
  }
  ASSERT_TRUE(recursive.update());
  const double whole =
      difference(recursive.latest().theta.cast<double>(), batch(rows, 0, rows.size()));
  EXPECT_LT(whole, 2e-5);  // 7e-6 measured
  EXPECT_LT(worst, 1e-3);  // 2e-4 measured
}

}  // namespace
}  // namespace dampline

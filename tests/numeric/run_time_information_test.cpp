// SPDX-License-Identifier: MIT
// Problems whose size is known at run time only: as Eigen solves them.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "dampline/numeric/information.hpp"
#include "tests/dense.hpp"

namespace dampline {
namespace {

constexpr int kMost = 7;
using RunTime = RunTimeInformation<kMost>;

/// [A b] of so many unknowns.
Eigen::MatrixXd problem(int rows, int unknowns, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal;
  Eigen::MatrixXd out(rows, unknowns + 1);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j <= unknowns; ++j) out(i, j) = normal(random);
  return out;
}

RunTime run_time_of(const Eigen::MatrixXd& ab) {
  RunTime out{static_cast<int>(ab.cols()) - 1};
  for (int i = 0; i < ab.rows(); ++i) {
    RunTime::Row row{};
    for (int j = 0; j < ab.cols(); ++j) row[static_cast<std::size_t>(j)] = ab(i, j);
    out.absorb(row);
  }
  return out;
}

Eigen::VectorXd vector_of(const RunTime::Vector& x, int size) {
  return Eigen::VectorXd::Map(x.data(), size);
}

TEST(RunTimeInformation, SolvesProblemsOfEverySize) {
  for (int unknowns = 1; unknowns <= kMost; ++unknowns) {
    const Eigen::MatrixXd ab = problem(30, unknowns, static_cast<std::uint64_t>(unknowns));
    const RunTime information = run_time_of(ab);
    EXPECT_EQ(information.size(), unknowns);
    EXPECT_EQ(information.undetermined(), -1);
    const Eigen::VectorXd truth = test::least_squares(ab.leftCols(unknowns), ab.col(unknowns));
    EXPECT_LT((vector_of(information.solve(), unknowns) - truth).norm(), 1e-12 * truth.norm());
    const double left = (ab.leftCols(unknowns) * truth - ab.col(unknowns)).norm();
    EXPECT_NEAR(std::abs(information.at(unknowns, unknowns)), left, 1e-12 * left);
    for (int j = 0; j <= unknowns; ++j)
      EXPECT_NEAR(information.column_norm(j), ab.col(j).norm(), 1e-12);
  }
}

TEST(RunTimeInformation, SolvesTheNormalEquationsOfAnyRightHandSide) {
  for (int unknowns = 1; unknowns <= kMost; ++unknowns) {
    const Eigen::MatrixXd ab = problem(30, unknowns, 40);
    const RunTime information = run_time_of(ab);
    RunTime::Vector y{};
    for (int i = 0; i < unknowns; ++i) y[static_cast<std::size_t>(i)] = 1.0 + 2.0 * i;
    const Eigen::MatrixXd a = ab.leftCols(unknowns);
    const Eigen::VectorXd truth = test::inverse(a.transpose() * a) * vector_of(y, unknowns);
    EXPECT_LT((vector_of(information.solve_normal(y), unknowns) - truth).norm(),
              1e-11 * truth.norm());
  }
}

TEST(RunTimeInformation, TwoHalvesMergeToTheWhole) {
  const Eigen::MatrixXd ab = problem(40, 5, 41);
  RunTime merged = run_time_of(ab.topRows(15));
  merged.merge(run_time_of(ab.bottomRows(25)));
  const Eigen::MatrixXd gram = ab.transpose() * ab;
  for (int i = 0; i <= 5; ++i) {
    for (int j = 0; j <= 5; ++j) {
      double sum = 0.0;
      for (int k = 0; k <= std::min(i, j); ++k) sum += merged.at(k, i) * merged.at(k, j);
      EXPECT_NEAR(sum, gram(i, j), 1e-12 * gram.norm()) << i << " " << j;
    }
  }
}

TEST(RunTimeInformation, NamesTheFirstUnknownThatIsNotDetermined) {
  EXPECT_EQ(RunTime{3}.undetermined(), 0);
  Eigen::MatrixXd ab = problem(40, 5, 42);
  ab.col(3) = 2.0 * ab.col(1) - ab.col(2);
  EXPECT_EQ(run_time_of(ab).undetermined(), 3);
  ab.col(1).setZero();
  EXPECT_EQ(run_time_of(ab).undetermined(), 1);
  ab = problem(40, 5, 43);
  ab.col(4) = ab.col(0) + 1e-5 * ab.col(4);
  EXPECT_EQ(run_time_of(ab).undetermined(), -1);
  EXPECT_EQ(run_time_of(ab).undetermined(1e-4), 4) << "as far as one is content with";
  ab(7, 2) = std::nan("");
  EXPECT_GE(run_time_of(ab).undetermined(), 0);
}

}  // namespace
}  // namespace dampline

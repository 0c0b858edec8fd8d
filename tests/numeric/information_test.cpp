// SPDX-License-Identifier: MIT
#include "dampline/numeric/information.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <random>

#include "dampline/numeric/cholesky.hpp"
#include "tests/dense.hpp"

namespace dampline {
namespace {

constexpr int kUnknowns = 6;
using Factor = Information<kUnknowns + 1>;

Eigen::MatrixXd random_matrix(int rows, int columns, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal;
  Eigen::MatrixXd out(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) out(i, j) = normal(random);
  }
  return out;
}

Factor factor_of(const Eigen::MatrixXd& ab) {
  Factor out;
  for (int i = 0; i < ab.rows(); ++i) out.absorb(ab.row(i).transpose());
  return out;
}

Eigen::VectorXd dense_solution(const Eigen::MatrixXd& ab) {
  return test::least_squares(ab.leftCols(kUnknowns), ab.col(kUnknowns));
}

TEST(Information, SolvesAsEigensDenseQr) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Eigen::MatrixXd ab = random_matrix(40, kUnknowns + 1, seed);
    Factor::Vector theta;
    ASSERT_TRUE(factor_of(ab).solve(theta));
    EXPECT_LT((theta - dense_solution(ab)).norm() / theta.norm(), 1e-12);
  }
}

TEST(Information, SolvesWhereTheNormalEquationsCouldNot) {
  Eigen::MatrixXd ab = random_matrix(60, kUnknowns + 1, 3);
  ab.col(1) = ab.col(0) + 1e-7 * ab.col(1);  // condition 1e7: its square leaves two digits
  ab.col(kUnknowns) = ab.leftCols(kUnknowns) * Eigen::VectorXd::Ones(kUnknowns);
  Factor::Vector theta;
  ASSERT_TRUE(factor_of(ab).solve(theta));
  EXPECT_LT((theta - Factor::Vector::Ones()).norm(), 1e-7);
}

TEST(Information, KeepsTheNormalEquations) {
  const Eigen::MatrixXd ab = random_matrix(50, kUnknowns + 1, 4);
  const Eigen::MatrixXd gram = ab.transpose() * ab;
  EXPECT_LT((factor_of(ab).gram() - gram).norm() / gram.norm(), 1e-14);
}

TEST(Information, TwoHalvesMergeToTheWhole) {
  const Eigen::MatrixXd ab = random_matrix(50, kUnknowns + 1, 5);
  Factor merged = factor_of(ab.topRows(20));
  merged.merge(factor_of(ab.bottomRows(30)));
  Factor::Vector theta;
  ASSERT_TRUE(merged.solve(theta));
  EXPECT_LT((theta - dense_solution(ab)).norm() / theta.norm(), 1e-12);
  const Eigen::MatrixXd gram = ab.transpose() * ab;
  EXPECT_LT((merged.gram() - gram).norm() / gram.norm(), 1e-14);
}

TEST(Information, MergesRowByRowAsAtOnce) {
  const Eigen::MatrixXd ab = random_matrix(30, kUnknowns + 1, 6);
  Factor whole = factor_of(ab.topRows(10));
  Factor by_rows = whole;
  const Factor other = factor_of(ab.bottomRows(20));
  whole.merge(other);
  for (int i = 0; i <= kUnknowns; ++i) by_rows.absorb_row_of(other, i);
  EXPECT_EQ(whole.packed(), by_rows.packed());
}

TEST(Information, ScaleForgetsByTheSquareOfItsFactor) {
  const Eigen::MatrixXd old = random_matrix(30, kUnknowns + 1, 7);
  const Eigen::MatrixXd fresh = random_matrix(30, kUnknowns + 1, 8);
  Factor factor = factor_of(old);
  factor.scale(0.5);
  factor.merge(factor_of(fresh));
  Eigen::MatrixXd weighted(60, kUnknowns + 1);
  weighted << 0.5 * old, fresh;
  Factor::Vector theta;
  ASSERT_TRUE(factor.solve(theta));
  EXPECT_LT((theta - dense_solution(weighted)).norm() / theta.norm(), 1e-12);
}

TEST(Information, InvertsTheNormalMatrix) {
  const Eigen::MatrixXd ab = random_matrix(40, kUnknowns + 1, 9);
  const Eigen::MatrixXd truth =
      test::inverse(ab.leftCols(kUnknowns).transpose() * ab.leftCols(kUnknowns));
  EXPECT_LT((factor_of(ab).inverse() - truth).norm() / truth.norm(), 1e-12);
}

TEST(Information, KnowsTheNormOfWhatIsLeft) {
  const Eigen::MatrixXd ab = random_matrix(40, kUnknowns + 1, 10);
  const double truth = (ab.leftCols(kUnknowns) * dense_solution(ab) - ab.col(kUnknowns)).norm();
  EXPECT_NEAR(factor_of(ab).residual_norm(), truth, 1e-12 * truth);
  for (int j = 0; j <= kUnknowns; ++j)
    EXPECT_NEAR(factor_of(ab).column_norm(j), ab.col(j).norm(), 1e-12);
}

TEST(Information, SaysWhenTheDataDoNotDetermineAnUnknown) {
  Factor::Vector theta;
  EXPECT_FALSE(Factor{}.solve(theta));
  Eigen::MatrixXd ab = random_matrix(40, kUnknowns + 1, 11);
  EXPECT_FALSE(factor_of(ab.topRows(kUnknowns - 1)).solve(theta)) << "fewer rows than unknowns";
  ab.col(4) = 2.0 * ab.col(1) - ab.col(2);
  EXPECT_FALSE(factor_of(ab).solve(theta)) << "dependent columns";
  ab.col(4).setZero();
  EXPECT_FALSE(factor_of(ab).solve(theta)) << "a column of zeros";
}

TEST(Information, NeverTakesNotANumberForASolution) {
  Eigen::MatrixXd ab = random_matrix(40, kUnknowns + 1, 12);
  ab(7, 3) = std::nan("");
  Factor::Vector theta;
  EXPECT_FALSE(factor_of(ab).solve(theta));
}

Factor factor_of_panels(const Eigen::MatrixXd& ab) {
  Factor out;
  for (int i = 0; i < ab.rows(); i += 5) {
    Factor::Panel<5> panel;
    for (int m = 0; m < 5; ++m) panel.set(static_cast<std::size_t>(m), ab.row(i + m).transpose());
    out.absorb_panel(panel);
  }
  return out;
}

TEST(Information, APanelHoldsItsRows) {
  const Eigen::MatrixXd ab = random_matrix(5, kUnknowns + 1, 19);
  Factor::Panel<5> panel;
  for (std::size_t m : {0U, 1U, 2U, 3U, 4U}) panel.set(m, ab.row(static_cast<int>(m)).transpose());
  for (std::size_t m : {0U, 1U, 2U, 3U, 4U})
    EXPECT_EQ(panel.row(m), ab.row(static_cast<int>(m)).transpose()) << m;
  panel.scale(3, 2.0);
  panel.clear(1);
  EXPECT_EQ(panel.row(3), 2.0 * ab.row(3).transpose());
  EXPECT_EQ(panel.row(1), Factor::Row::Zero());
  EXPECT_EQ(panel.row(2), ab.row(2).transpose());
  EXPECT_EQ(panel.row(4), ab.row(4).transpose());
}

TEST(Information, TakesPanelsAsWellAsRows) {
  Eigen::MatrixXd ab = random_matrix(60, kUnknowns + 1, 16);
  ab.col(1) = ab.col(0) + 1e-7 * ab.col(1);  // the normal equations would leave two digits
  ab.col(2).setZero();
  ab.col(2)[37] = 1.0;
  ab.col(kUnknowns) = ab.leftCols(kUnknowns) * Eigen::VectorXd::Ones(kUnknowns);
  const Factor panels = factor_of_panels(ab);
  Factor::Vector theta;
  ASSERT_TRUE(panels.solve(theta));
  EXPECT_LT((theta - Factor::Vector::Ones()).norm(), 1e-7);
  const auto gram = factor_of(ab).gram();
  EXPECT_LT((panels.gram() - gram).norm() / gram.norm(), 1e-14);
}

TEST(Information, TakesPanelsAfterWhatHasFadedBelowTheSmallestNumbers) {
  const Eigen::MatrixXd ab = random_matrix(60, kUnknowns + 1, 17);
  Factor factor = factor_of_panels(ab.topRows(20));
  for (int i = 0; i < 8'000; ++i) factor.scale(0.83);
  factor.merge(factor_of_panels(1e-160 * ab.topRows(20)));
  factor.merge(factor_of_panels(ab.bottomRows(40)));
  Factor::Vector theta;
  ASSERT_TRUE(factor.solve(theta));
  EXPECT_LT((theta - dense_solution(ab.bottomRows(40))).norm(), 1e-12 * theta.norm());
}

TEST(Information, NeverTakesAPanelWithNotANumberForASolution) {
  Eigen::MatrixXd ab = random_matrix(60, kUnknowns + 1, 18);
  ab(17, 2) = std::nan("");
  Factor::Vector theta;
  EXPECT_FALSE(factor_of_panels(ab).solve(theta));
}

// What hours of forgetting at a standstill leave of a factor; it must not become 0 / 0.
TEST(Information, StartsAnewFromWhatHasFadedBelowTheSmallestNumbers) {
  const Eigen::MatrixXd ab = random_matrix(60, kUnknowns + 1, 15);
  Factor factor = factor_of(ab.topRows(20));
  for (int i = 0; i < 8'000; ++i) factor.scale(0.83);
  const Eigen::MatrixXd later = ab.bottomRows(40);
  for (int i = 0; i < later.rows(); ++i) factor.absorb(later.row(i).transpose());
  Factor::Vector theta;
  ASSERT_TRUE(factor.solve(theta));
  Factor::Vector truth;
  ASSERT_TRUE(factor_of(later).solve(truth));
  EXPECT_LT((theta - truth).norm(), 1e-12 * truth.norm());
}

TEST(Information, MapsColumnsOntoOthers) {
  const Eigen::MatrixXd ab = random_matrix(40, kUnknowns + 1, 13);
  Eigen::Matrix<double, kUnknowns + 1, 3> map = random_matrix(kUnknowns + 1, 3, 14);
  Information<3> mapped;
  factor_of(ab).add_mapped(map, 4.0, mapped);
  const Eigen::MatrixXd truth = 4.0 * (ab * map).transpose() * (ab * map);
  EXPECT_LT((mapped.gram() - truth).norm() / truth.norm(), 1e-13);
}

TEST(SolveCholesky, SolvesAsEigen) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Eigen::MatrixXd r = random_matrix(20, 5, seed);
    const Eigen::Matrix<double, 5, 5> a = r.transpose() * r;
    const Eigen::Matrix<double, 5, 1> b = random_matrix(5, 1, seed + 100);
    const Eigen::Matrix<double, 5, 1> truth = test::inverse(a) * b;
    EXPECT_LT((solve_cholesky<5>(a, b) - truth).norm() / truth.norm(), 1e-12);
  }
}

TEST(SolveCholesky, GivesNotANumberForWhatIsNotDetermined) {
  Eigen::Matrix<double, 3, 3> a = Eigen::Matrix<double, 3, 3>::Identity();
  a(2, 2) = -1.0;
  const Eigen::Matrix<double, 3, 1> x = solve_cholesky<3>(a, Eigen::Matrix<double, 3, 1>::Ones());
  EXPECT_TRUE(std::isnan(x[2]));
}

}  // namespace
}  // namespace dampline

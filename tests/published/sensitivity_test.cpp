// SPDX-License-Identifier: MIT
#include "published/oscillator/sensitivity.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>

#include "tests/dense.hpp"

namespace dampline {
namespace {

TEST(Sensitivity, OfAListHoldsEachFunctionOnceAndNoConstants) {
  using Linear = TermList<Viscous, Spring>;
  static_assert(std::is_same_v<Sensitivities<Linear>, FunctionList<>>);
  using Both = TermList<Viscous, Spring, CubicSpring, VanDerPolDamper, Friction<>>;
  static_assert(std::is_same_v<Sensitivities<Both>, FunctionList<Power<2, 0>, Power<1, 1>>>);
  using Sided = TermList<Spring, ProgressiveFriction<>, ProgressiveFriction<>>;
  static_assert(std::is_same_v<Sensitivities<Sided>, FunctionList<SidedSign>>);
  EXPECT_EQ((kPlaceOf<CubicSpring, Both>), 2);
  EXPECT_EQ((kPlaceOf<CubicSpring, Linear>), -1);
}

/// Numerical derivatives of the term at scattered places are combinations of the functions.
template <class T>
void expect_spanned() {
  using Functions = Sensitivities<TermList<T>>;
  const T term{};
  for (const bool by_x : {true, false}) {
    Eigen::MatrixXd functions{24, 1 + Functions::kCount};
    Eigen::VectorXd slope{24};
    for (int i = 0; i < 24; ++i) {
      const double x = (i % 5 - 1.7) * 0.8;
      const double v = (i % 7 - 2.6) * 0.5;
      constexpr double kStep = 1e-5;
      slope[i] = by_x ? (term(x + kStep, v) - term(x - kStep, v)) / (2.0 * kStep)
                      : (term(x, v + kStep) - term(x, v - kStep)) / (2.0 * kStep);
      Eigen::Matrix<double, 1 + Functions::kCount, 1> row;
      row[0] = 1.0;
      Functions::fill(x, v, row, 1);
      functions.row(i) = row.transpose();
    }
    const Eigen::VectorXd fit = test::least_squares(functions, slope);
    EXPECT_LT((functions * fit - slope).norm(), 1e-8 * (1.0 + slope.norm())) << by_x;
  }
}

TEST(Sensitivity, SpansTheDerivativesOfItsTerm) {
  expect_spanned<Viscous>();
  expect_spanned<Spring>();
  expect_spanned<CubicSpring>();
  expect_spanned<VanDerPolDamper>();
  expect_spanned<Power<1, 1>>();
  expect_spanned<Power<0, 3>>();
  expect_spanned<Friction<>>();
  expect_spanned<ProgressiveFriction<>>();
}

}  // namespace
}  // namespace dampline

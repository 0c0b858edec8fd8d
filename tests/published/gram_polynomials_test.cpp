// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "published/oscillator/drift_free_window.hpp"

namespace dampline {
namespace {

constexpr int kCount = 8;
constexpr int kPoints = 1800;

TEST(GramPolynomials, AreOrthonormal) {
  const GramPolynomials<kCount, kPoints> polynomials;
  double product[kCount][kCount]{};
  for (int n = 0; n < kPoints; ++n) {
    const auto p = polynomials.at(n);
    for (std::size_t i = 0; i < kCount; ++i) {
      for (std::size_t j = 0; j < kCount; ++j) product[i][j] += p[i] * p[j];
    }
  }
  for (int i = 0; i < kCount; ++i) {
    for (int j = 0; j < kCount; ++j) EXPECT_NEAR(product[i][j], i == j ? 1.0 : 0.0, 1e-12);
  }
}

/// A polynomial of degree j - 1 is orthogonal to p_j; one of degree j is not.
TEST(GramPolynomials, HaveTheDegreeOfTheirIndex) {
  const GramPolynomials<kCount, kPoints> polynomials;
  for (std::size_t degree = 0; degree < kCount; ++degree) {
    std::array<double, kCount> with{};
    double square = 0.0;
    for (int n = 0; n < kPoints; ++n) {
      const double power = std::pow((n - 700.0) / 1000.0, static_cast<double>(degree));
      square += power * power;
      const auto p = polynomials.at(n);
      for (std::size_t j = 0; j < kCount; ++j) with[j] += p[j] * power;
    }
    for (std::size_t j = degree + 1; j < kCount; ++j) {
      EXPECT_NEAR(with[j], 0.0, 1e-11 * std::sqrt(square)) << degree << ' ' << j;
    }
    EXPECT_GT(std::abs(with[degree]), 1e-4 * std::sqrt(square));
  }
}

}  // namespace
}  // namespace dampline

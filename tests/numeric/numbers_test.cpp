// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <tuple>
#include <utility>

#include "dampline/numeric/cholesky.hpp"
#include "dampline/numeric/fourier.hpp"
#include "dampline/numeric/log_histogram.hpp"
#include "dampline/numeric/mean_t.hpp"
#include "dampline/numeric/random.hpp"
#include "dampline/numeric/wide.hpp"

namespace dampline {
namespace {

TEST(Fourier, TurnsAreCosineAndSineToTheLastDigits) {
  for (std::size_t k = 0; k < 256; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / 512.0;
    EXPECT_NEAR(Fourier512::turn(k).real(), std::cos(angle), 5e-16) << k;
    EXPECT_NEAR(Fourier512::turn(k).imag(), -std::sin(angle), 5e-16) << k;
  }
  EXPECT_EQ(Fourier512::turn(64).real(), -Fourier512::turn(64).imag()) << "an eighth of a turn";
}

TEST(Fourier, IsTheSumOfItsDefinitionForEveryBin) {
  std::mt19937 random{5};
  std::normal_distribution<double> normal;
  std::array<std::complex<double>, 512> x{};
  for (auto& value : x) value = {normal(random), normal(random)};
  Fourier512 fourier;
  for (int round = 0; round < 2; ++round) {  // it can be started again
    for (std::size_t n = 0; n < x.size(); ++n) fourier.set(n, x[n]);
    fourier.start();
    EXPECT_FALSE(fourier.advance(Fourier512::kButterflies - 1));
    EXPECT_TRUE(fourier.advance(1));
    EXPECT_TRUE(fourier.advance(5)) << "and stays done";
    for (std::size_t k = 0; k < 512; ++k) {
      std::complex<double> sum;
      for (std::size_t n = 0; n < x.size(); ++n)
        sum += x[n] *
               std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(n * k % 512) / 512.0);
      ASSERT_NEAR(std::abs(fourier[k] - sum), 0.0, 1e-11) << k;
    }
  }
  EXPECT_EQ(phase_of({0.0, 2.0}), 0.5 * std::numbers::pi);
}

// Figures of another implementation of splitmix64 and xoshiro256++.
TEST(Random, IsTheGeneratorThatIsNamed) {
  Random first{1, 0};
  for (const unsigned long long bits :
       {0xcfc5d07f6f03c29bULL, 0xbf424132963fe08dULL, 0x19a37d5757aaf520ULL, 0xbf08119f05cd56d6ULL,
        0x2f47184b86186fa4ULL, 0x97299fcae7202345ULL})
    EXPECT_EQ(first.bits(), bits);
  Random second{42, 7};
  for (const unsigned long long bits :
       {0x617ceb2a37ae9095ULL, 0x44b25df93fe15cd7ULL, 0x9b969f06bc8ea26aULL, 0x4c2c2db24836d996ULL,
        0xfa9abb932ac4fc02ULL, 0x6b716d1fc2e1d8d3ULL})
    EXPECT_EQ(second.bits(), bits);
  Random uniform{1, 0};
  EXPECT_EQ(uniform.uniform(),
            static_cast<double>(std::uint64_t{0xcfc5d07f6f03c29bULL} >> 11U) / 9007199254740992.0);
}

TEST(Random, GivesNormalNumbersInPairs) {
  Random random{3, 1};
  double mean = 0.0, square = 0.0, fourth = 0.0, product = 0.0, last = 0.0;
  constexpr int kCount = 200'000;
  int beyond = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.normal();
    mean += x / kCount;
    square += x * x / kCount;
    fourth += x * x * x * x / kCount;
    product += x * last / kCount;
    beyond += std::abs(x) > 3.0 ? 1 : 0;
    last = x;
  }
  EXPECT_NEAR(mean, 0.0, 0.01);
  EXPECT_NEAR(square, 1.0, 0.015);
  EXPECT_NEAR(fourth, 3.0, 0.1);
  EXPECT_NEAR(product, 0.0, 0.01);
  EXPECT_NEAR(beyond, 0.0027 * kCount, 80.0);
}

// Marsaglia: u f and v f of the next point within the circle, f = sqrt(-2 ln s / s).
TEST(Random, NormalNumbersAreMarsagliasPolarOnes) {
  Random normal{9, 2};
  Random uniform{9, 2};
  for (int pair = 0; pair < 100; ++pair) {
    double u = 1.0, v = 1.0;
    while (u * u + v * v >= 1.0) {
      u = 2.0 * uniform.uniform() - 1.0;
      v = 2.0 * uniform.uniform() - 1.0;
    }
    const double s = u * u + v * v;
    const double factor = std::sqrt(-2.0 * std::log(s) / s);
    EXPECT_NEAR(normal.normal(), u * factor, 1e-15);
    EXPECT_NEAR(normal.normal(), v * factor, 1e-15);
  }
}

TEST(MagnitudeHistogram, SmallNumbersAreExactAndLargeOnesWithinAnEighth) {
  for (const std::uint64_t x : {0U, 1U, 7U, 8U, 9U, 15U}) {
    MagnitudeHistogram histogram;
    histogram.add(x);
    EXPECT_EQ(histogram.median(), static_cast<double>(x));
  }
  for (std::uint64_t x = 16; x < std::uint64_t{1} << 40U; x = x * 17 / 16 + 1) {
    MagnitudeHistogram histogram;
    histogram.add(x);
    EXPECT_NEAR(histogram.median() / static_cast<double>(x), 1.0, 1.0 / 16.0) << x;
  }
  MagnitudeHistogram largest;
  largest.add(~std::uint64_t{0});
  EXPECT_GT(largest.median(), 1e12) << "beyond its range it is the last bin";
  EXPECT_LT(largest.median(), 2.2e12);
}

TEST(MagnitudeHistogram, QuantilesAreThoseOfWhatWasCounted) {
  MagnitudeHistogram histogram;
  EXPECT_EQ(histogram.median(), 0.0);
  EXPECT_EQ(histogram.count(), 0U);
  for (const std::uint64_t x : {1U, 2U, 2U, 3U, 5U, 6U, 6U, 6U}) histogram.add(x);
  EXPECT_EQ(histogram.count(), 8U);
  EXPECT_EQ(histogram.median(), 3.0);
  EXPECT_EQ(histogram.quantile(0.125), 1.0);
  EXPECT_EQ(histogram.quantile(0.126), 2.0);
  EXPECT_EQ(histogram.quantile(0.9), 6.0);
  EXPECT_EQ(histogram.quantile(1.0), 6.0);
  histogram.clear();
  EXPECT_EQ(histogram.count(), 0U);
  histogram.add(4);
  EXPECT_EQ(histogram.median(), 4.0);
}

TEST(LogHistogram, KnowsQuantilesToTwoPercent) {
  for (double x = 1e-17; x < 1e6; x *= 1.37) {
    LogHistogram histogram;
    histogram.add(x);
    EXPECT_NEAR(histogram.quantile(0.5) / x, 1.0, 0.0219) << x;
  }
  LogHistogram ends;
  ends.add(0.0);
  ends.add(-1.0);
  ends.add(std::nan(""));
  EXPECT_EQ(ends.count(), 0U);
  ends.add(1e-30);
  EXPECT_NEAR(ends.quantile(0.5), std::exp2(-60.0 + 0.5 / 16.0), 1e-25);
  ends.clear();
  ends.add(1e30);
  EXPECT_NEAR(ends.quantile(0.5), std::exp2(20.0 - 0.5 / 16.0), 1.0);
}

TEST(Cholesky, FactorsAndSolvesTheLeadingPart) {
  std::mt19937 random{3};
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, 6, 6> m;
  for (int i = 0; i < 36; ++i) m.data()[i] = normal(random);
  const Eigen::Matrix<double, 6, 6> a = m * m.transpose();
  for (int size = 1; size <= 6; ++size) {
    Cholesky<6> cholesky;
    ASSERT_TRUE(cholesky.factor(a, size));
    Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::LinSpaced(1.0, 6.0);
    const auto before = b;
    cholesky.solve(b);
    const Eigen::VectorXd back = a.topLeftCorner(size, size) * b.head(size);
    EXPECT_LT((back - before.head(size)).norm(), 1e-9) << size;
    for (int i = size; i < 6; ++i) EXPECT_EQ(b[i], before[i]);
    // |L^-1 b|^2 = b' A^-1 b
    auto half = before;
    cholesky.forward(half);
    EXPECT_NEAR(half.head(size).squaredNorm(), before.head(size).dot(b.head(size)), 1e-9);
    cholesky.backward(half);
    EXPECT_LT((half.head(size) - b.head(size)).norm(), 1e-12);
  }
}

TEST(Cholesky, RefusesAPivotThatIsNotAboveItsTolerance) {
  for (const auto& [left, tolerance, good] :
       {std::tuple{1.1e-12, 1e-12, true}, std::tuple{0.9e-12, 1e-12, false},
        std::tuple{1e-6, 1e-5, false}, std::tuple{0.0, 0.0, false}, std::tuple{-1.0, 0.0, false}}) {
    Eigen::Matrix2d a;
    a << 1.0, 0.0, 0.0, 1.0;
    Eigen::Matrix3d all = Eigen::Matrix3d::Identity();
    all(1, 0) = all(0, 1) = 1.0;
    all(1, 1) = 1.0 + left;
    Cholesky<3> cholesky;
    EXPECT_EQ(cholesky.factor(all, 3, tolerance), good) << left;
    EXPECT_TRUE(cholesky.factor(a, 2, tolerance));
  }
}

// S = sum s s' + 1/2 sum (s s_-1' + s_-1 s'), then A^-1 S A^-1.
TEST(ScoreScatter, IsThatOfNeweyAndWestWithOneLag) {
  using Vector = Eigen::Vector2d;
  using Square = Eigen::Matrix2d;
  const std::array<Vector, 3> scores{Vector{1.0, 2.0}, Vector{-3.0, 0.5}, Vector{0.25, 4.0}};
  ScoreScatter<2> scatter;
  ScoreScatter<2> first_alone;
  Square expected = Square::Zero();
  for (std::size_t b = 0; b < scores.size(); ++b) {
    scatter.add(scores[b]);
    first_alone.add(scores[b], 1);
    expected += scores[b] * scores[b].transpose();
    if (b > 0)
      expected +=
          0.5 * (scores[b] * scores[b - 1].transpose() + scores[b - 1] * scores[b].transpose());
  }
  Square inverse;
  inverse << 2.0, 0.5, 0.5, 3.0;
  EXPECT_LT((scatter.covariance(inverse) - inverse * expected * inverse).norm(), 1e-12);
  const Square one = first_alone.covariance(Square::Identity());
  EXPECT_NEAR(one(0, 0), expected(0, 0), 1e-12);
  EXPECT_EQ(one(1, 1), 0.0);
  EXPECT_EQ(one(0, 1), 0.0);
}

template <std::size_t Size>
void expect_window_of() {
  std::mt19937 random{11};
  std::normal_distribution<double> normal;
  std::array<double, Size> weights{};
  for (double& w : weights) w = normal(random);
  SlidingWindow<Size> window;
  std::array<double, Size> latest{};
  for (int n = 0; n < 200; ++n) {
    const double x = normal(random);
    window.push(x);
    std::move(latest.begin() + 1, latest.end(), latest.begin());
    latest.back() = x;
    double sum = 0.0;
    for (std::size_t i = 0; i < Size; ++i) sum += weights[i] * latest[i];
    ASSERT_NEAR(window.dot(weights), sum, 1e-12) << n << " of " << Size;
  }
}

TEST(SlidingWindow, WeighsTheLatestTheOldestFirst) {
  expect_window_of<1>();
  expect_window_of<7>();
  expect_window_of<9>();
  expect_window_of<17>();
  expect_window_of<25>();
  expect_window_of<41>();
  expect_window_of<42>();
}

// 2.5 with a deviation of the values of sqrt(5 / 3), of their mean half of that.
TEST(MeanT, IsTheMeanOverItsDeviation) {
  MeanT mean;
  EXPECT_EQ(mean.t(), 0.0);
  mean.add(1.0);
  EXPECT_EQ(mean.t(), 0.0) << "of one";
  for (const double x : {2.0, 3.0, 4.0}) mean.add(x);
  EXPECT_EQ(mean.count(), 4.0);
  EXPECT_NEAR(mean.t(), std::sqrt(15.0), 1e-12);
  MeanT same;
  for (int i = 0; i < 5; ++i) same.add(0.5);
  EXPECT_EQ(same.t(), 0.0);
}

}  // namespace
}  // namespace dampline

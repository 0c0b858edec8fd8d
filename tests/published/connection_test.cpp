// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "published/wavelet/daubechies.hpp"
#include "tests/published/generate/connection_header.hpp"
#include "tests/published/generate/exact_connection.hpp"

namespace dampline {
namespace {

using generate::connection;

mpq_class power(int base, int exponent) {
  mpq_class out = 1;
  for (int i = 0; i < exponent; ++i) out *= base;
  return out;
}

mpq_class moment(const std::vector<mpq_class>& gamma, int q) {
  const int reach = static_cast<int>(gamma.size() / 2);
  mpq_class sum = 0;
  for (int k = -reach; k <= reach; ++k) {
    sum += power(k, q) * gamma[static_cast<std::size_t>(k + reach)];
  }
  return sum;
}

/// Gamma_0...Gamma_K.
std::vector<std::string> right_half(const std::vector<mpq_class>& gamma) {
  std::vector<std::string> out;
  for (std::size_t i = gamma.size() / 2; i < gamma.size(); ++i) out.push_back(gamma[i].get_str());
  return out;
}

TEST(ConnectionTables, AreWhatTheGeneratorWrites) {
  std::ifstream file{DAMPLINE_SOURCE_DIR "/firmware_core/published/wavelet/daubechies.hpp"};
  ASSERT_TRUE(file);
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_TRUE(text.str() == generate::connection_header()) << "build the target connection_tables";
}

class Connection : public testing::TestWithParam<int> {};

// x^q is differentiated exactly up to the first moment that fails.
TEST_P(Connection, DifferentiatesPolynomialsExactly) {
  const int n = GetParam();
  const auto first = connection(n, 1);
  const auto second = connection(n, 2);
  for (int q = 0; q <= 2 * n; ++q) EXPECT_EQ(moment(first, q), q == 1 ? 1 : 0) << q;
  for (int q = 0; q <= 2 * n - 1; ++q) EXPECT_EQ(moment(second, q), q == 2 ? 2 : 0) << q;
  EXPECT_NE(moment(first, 2 * n + 1), 0);
  EXPECT_NE(moment(second, 2 * n), 0);
}

TEST_P(Connection, FirstIsOddAndSecondEven) {
  const auto first = connection(GetParam(), 1);
  const auto second = connection(GetParam(), 2);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i], -first[first.size() - 1 - i]);
    EXPECT_EQ(second[i], second[second.size() - 1 - i]);
  }
}

INSTANTIATE_TEST_SUITE_P(VanishingMoments, Connection, testing::Values(3, 4, 6, 8));

TEST(Connection, OfD6AreThePublishedFractions) {
  EXPECT_EQ(right_half(connection(3, 1)),
            (std::vector<std::string>{"0", "272/365", "-53/365", "16/1095", "1/2920"}));
  EXPECT_EQ(right_half(connection(3, 2)),
            (std::vector<std::string>{"-295/56", "356/105", "-92/105", "4/35", "3/560"}));
}

TEST(Connection, OfD8AreThePublishedFractions) {
  EXPECT_EQ(right_half(connection(4, 1)),
            (std::vector<std::string>{"0", "39296/49553", "-76113/396424", "1664/49553",
                                      "-2645/1189272", "-128/743295", "1/1189272"}));
  EXPECT_EQ(
      right_half(connection(4, 2)),
      (std::vector<std::string>{"-342643/82248", "2852128/1079505", "-12053651/17272080",
                                "162976/1079505", "-60871/5757360", "-352/215901", "55/3454416"}));
}

TEST(InterpolantMask, ReproducesPolynomialsMidway) {
  for (const int n : {3, 4, 6, 8}) {
    const auto mask = generate::interpolant_mask(n);
    for (int q = 0; q < 2 * n; ++q) {
      mpq_class odd = 0;  // sum over odd k of a_k k^q: the value at 0 of y^q from the nodes k
      for (int k = 1 - 2 * n; k <= 2 * n - 1; k += 2) {
        odd += mask[static_cast<std::size_t>(k + 2 * n - 1)] * power(k, q);
      }
      EXPECT_EQ(odd, q == 0 ? 1 : 0) << n << " " << q;
    }
  }
}

template <class Wavelet>
class LowPass : public testing::Test {};
using Wavelets = testing::Types<D6, D8, D12, D16>;
TYPED_TEST_SUITE(LowPass, Wavelets);

TYPED_TEST(LowPass, IsOrthonormalToItsEvenShifts) {
  const auto& h = TypeParam::kLowPass;
  for (std::size_t shift = 0; shift < h.size(); shift += 2) {
    double sum = 0.0;
    for (std::size_t k = 0; k + shift < h.size(); ++k) sum += h[k] * h[k + shift];
    EXPECT_NEAR(sum, shift == 0 ? 1.0 : 0.0, 1e-15);
  }
}

TYPED_TEST(LowPass, HasItsVanishingMoments) {
  const auto& h = TypeParam::kLowPass;
  for (int q = 0; q < TypeParam::kVanishingMoments; ++q) {
    double sum = 0.0;
    double size = 0.0;
    for (std::size_t k = 0; k < h.size(); ++k) {
      const double term = std::pow(static_cast<double>(k), q) * h[k];
      sum += k % 2 == 0 ? term : -term;
      size += std::abs(term);
    }
    EXPECT_LT(std::abs(sum), 1e-15 * size) << q;
  }
}

// The autocorrelation of phi is the interpolant: two ways to the same function.
TYPED_TEST(LowPass, HasTheInterpolantsMaskAsItsAutocorrelation) {
  const auto& h = TypeParam::kLowPass;
  const int taps = static_cast<int>(h.size());
  const auto mask = generate::interpolant_mask(TypeParam::kVanishingMoments);
  for (int shift = 0; shift < taps; ++shift) {
    double sum = 0.0;
    for (int k = 0; k + shift < taps; ++k) {
      sum += h[static_cast<std::size_t>(k)] * h[static_cast<std::size_t>(k + shift)];
    }
    EXPECT_NEAR(sum, mask[static_cast<std::size_t>(shift + taps - 1)].get_d(), 1e-15);
  }
}

}  // namespace
}  // namespace dampline

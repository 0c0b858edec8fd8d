// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "published/wavelet/motion_rows.hpp"

namespace dampline {
namespace {

template <class Wavelet>
class Stencil : public testing::Test {};
using Wavelets = testing::Types<D6, D8, D12, D16>;
TYPED_TEST_SUITE(Stencil, Wavelets);

template <class Wavelet>
struct Derivatives {
  double first;
  double second;
};

/// Of sin(t + 0.4) at t = 0.
template <class Wavelet>
Derivatives<Wavelet> of_sine(double step) {
  RecentValues<double, 2 * Wavelet::kReach + 1> recent;
  for (int i = -Wavelet::kReach; i <= Wavelet::kReach; ++i) recent.push(std::sin(i * step + 0.4));
  return {first_derivative<Wavelet>(recent, Wavelet::kReach, step),
          second_derivative<Wavelet>(recent, Wavelet::kReach, step)};
}

// Halving the step divides the error by 2^order.
TYPED_TEST(Stencil, ConvergesWithItsOrder) {
  const auto coarse = of_sine<TypeParam>(0.8);
  const auto fine = of_sine<TypeParam>(0.4);
  const double first_order =
      std::log2(std::abs((coarse.first - std::cos(0.4)) / (fine.first - std::cos(0.4))));
  const double second_order =
      std::log2(std::abs((coarse.second + std::sin(0.4)) / (fine.second + std::sin(0.4))));
  EXPECT_NEAR(first_order, 2 * TypeParam::kVanishingMoments, 0.6);
  EXPECT_NEAR(second_order, 2 * TypeParam::kVanishingMoments - 2, 0.6);
}

// Relative error of the second derivative at omega h = 0.1, 0.2, 0.4 and 0.8.
TEST(Stencil, HasThePublishedErrorAtFourResolutions) {
  const auto error_of_d8 = [](double step) {
    return std::abs(of_sine<D8>(step).second / -std::sin(0.4) - 1.0);
  };
  EXPECT_NEAR(error_of_d8(0.1), 2.4e-8, 0.1e-8);
  EXPECT_NEAR(error_of_d8(0.2), 1.5e-6, 0.1e-6);
  EXPECT_NEAR(error_of_d8(0.4), 9.3e-5, 0.1e-5);
  EXPECT_NEAR(error_of_d8(0.8), 4.9e-3, 0.1e-3);
  EXPECT_NEAR(std::abs(of_sine<D12>(0.8).second / -std::sin(0.4) - 1.0), 8.1e-5, 0.1e-5);
}

TEST(RecentValues, KeepTheLatestInOrder) {
  RecentValues<int, 3> recent;
  recent.push(1);
  recent.push(2);
  EXPECT_FALSE(recent.full());
  recent.push(3);
  EXPECT_TRUE(recent.full());
  recent.push(4);
  EXPECT_EQ(recent.back(0), 4);
  EXPECT_EQ(recent.back(1), 3);
  EXPECT_EQ(recent.back(2), 2);
}

}  // namespace
}  // namespace dampline

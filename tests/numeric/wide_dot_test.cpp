// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <random>
#include <vector>

#include "dampline/numeric/wide.hpp"

namespace dampline {
namespace {

/// Number by number, in the order that is promised.
double in_promised_order(const double* a, const double* b, std::size_t count) {
  std::array<double, 8> lane{};
  std::size_t i = 0;
  for (; i < count / 4 * 4; ++i) lane[i % 8] += a[i] * b[i];
  double sum = ((lane[0] + lane[4]) + (lane[2] + lane[6])) +  //
               ((lane[1] + lane[5]) + (lane[3] + lane[7]));
  for (; i < count; ++i) sum += a[i] * b[i];
  return sum;
}

/// Whatever vectors the processor has, and wherever the numbers lie.
TEST(WideDot, HasTheBitsOfTheOrderThatIsPromised) {
  std::mt19937 random{7};
  std::uniform_real_distribution<double> number{-1.0, 1.0};
  std::vector<double> a(80);
  std::vector<double> b(80);
  for (double& x : a) x = number(random);
  for (double& x : b) x = number(random);
  for (std::size_t first = 0; first < 4; ++first) {
    for (std::size_t count = 0; count <= 70; ++count) {
      EXPECT_EQ(wide_dot(&a[first], b.data(), count), in_promised_order(&a[first], b.data(), count))
          << count << " numbers from " << first << " on";
    }
  }
}

}  // namespace
}  // namespace dampline

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "published/oscillator/drift_free_window.hpp"

namespace dampline {
namespace {

TEST(FlatIntegral, IsExactForPolynomialsUpToDegreeNine) {
  for (int degree = 0; degree <= 9; ++degree) {
    const auto at = [&](long i) { return std::pow(0.1 * static_cast<double>(i), degree); };
    const auto primitive = [&](double i) { return std::pow(0.1 * i, degree + 1) / (degree + 1); };
    const double exact = 10.0 * (primitive(3.0) - primitive(2.0));
    EXPECT_NEAR(FlatIntegral::over_step(3, at), exact, 2e-15) << degree;
  }
  const auto tenth = [](long i) { return std::pow(static_cast<double>(i), 10.0); };
  EXPECT_GT(
      std::abs(FlatIntegral::over_step(3, tenth) - (std::pow(3.0, 11) - std::pow(2.0, 11)) / 11.0),
      1.0);
}

TEST(FlatIntegral, HasTheGainThatIsStated) {
  const auto gain_error = [](double cycles_per_sample) {
    const double w = 2.0 * std::numbers::pi * cycles_per_sample;
    const double found = FlatIntegral::over_step(
        0, [&](long i) { return std::cos(w * (static_cast<double>(i) + 0.5)); });
    return found / (2.0 * std::sin(0.5 * w) / w) - 1.0;
  };
  for (double f = 0.001; f < 0.1; f += 0.001) EXPECT_LT(std::abs(gain_error(f)), 3e-6) << f;
  EXPECT_LT(std::abs(gain_error(0.2)), 1.0e-3);
  EXPECT_GT(std::abs(gain_error(0.3)), 1.0e-2);
}

}  // namespace
}  // namespace dampline

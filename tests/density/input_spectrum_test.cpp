// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "dampline/density/input_statistics.hpp"
#include "sim_hw/noise.hpp"

namespace dampline {
namespace {

constexpr double kRateHz = 300.0;
using Sums = InputSpectrum::Sums;

// Against the sum that defines a periodogram.
TEST(InputSpectrum, IsAWindowedPeriodogram) {
  sim::Random random{1, sim::Stream::kTrack};
  std::vector<double> x;
  for (std::size_t i = 0; i < InputSpectrum::kLength; ++i) x.push_back(random.normal() + 3.0);
  InputSpectrum spectrum{kRateHz};
  Sums sums;
  for (const double value : x) spectrum.update(value, 1.0, sums);
  ASSERT_EQ(sums.weight, 1.0);
  const auto length = static_cast<double>(InputSpectrum::kLength);
  for (std::size_t k = 0; k < InputSpectrum::kLines; ++k) {
    std::complex<double> sum;
    double squares = 0.0;
    for (std::size_t n = 0; n < x.size(); ++n) {
      const double t = static_cast<double>(n) + 0.5;
      const double window = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * t / length);
      squares += window * window;
      const double turns = spectrum.frequency_hz(k) / kRateHz * t;
      sum += window * x[n] * std::polar(1.0, -2.0 * std::numbers::pi * turns);
    }
    const double expected = std::norm(sum) / (kRateHz * squares);
    EXPECT_NEAR(sums.power[k], expected, 1e-9 * expected + 1e-15) << k;
  }
}

TEST(InputSpectrum, OfWhiteNoiseIsItsLevel) {
  sim::Random random{2, sim::Stream::kTrack};
  InputSpectrum spectrum{kRateHz};
  Sums sums;
  for (int i = 0; i < 600'000; ++i) spectrum.update(0.7 * random.normal(), 1.0, sums);
  double mean = 0.0;
  for (const double power : sums.power) mean += power / sums.weight / InputSpectrum::kLines;
  EXPECT_NEAR(mean, 0.49 / kRateHz, 0.01 * 0.49 / kRateHz);
  for (const double power : sums.power) {
    EXPECT_NEAR(power / sums.weight, 0.49 / kRateHz, 0.15 * 0.49 / kRateHz);
  }
}

TEST(InputSpectrum, DoesNotSeeAConstant) {
  InputSpectrum spectrum{kRateHz};
  Sums sums;
  for (int i = 0; i < 5'000; ++i) spectrum.update(9.81, 1.0, sums);
  EXPECT_GT(sums.weight, 15.0);
  for (const double power : sums.power) EXPECT_LT(power, 1e-15);
}

TEST(InputSpectrum, OverlapsByHalfAndStartsAnewAfterAGap) {
  InputSpectrum spectrum{kRateHz};
  Sums sums;
  const auto run = [&](std::size_t samples) {
    for (std::size_t i = 0; i < samples; ++i) spectrum.update(1.0, 1.0, sums);
  };
  run(InputSpectrum::kLength - 1);
  EXPECT_EQ(sums.weight, 0.0);
  run(1);
  EXPECT_EQ(sums.weight, 1.0);
  run(InputSpectrum::kLength / 2);
  EXPECT_EQ(sums.weight, 2.0);
  spectrum.reset();
  run(InputSpectrum::kLength - 1);
  EXPECT_EQ(sums.weight, 2.0);
}

}  // namespace
}  // namespace dampline

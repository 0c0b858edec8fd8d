// SPDX-License-Identifier: MIT
#include "dampline/motion/drift_free_integral.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "tests/steps.hpp"

namespace dampline {
namespace {

using Corner = Baseline::Corner;
constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// What came out, and for which sample.
struct Integrated {
  std::vector<double> time_s;
  std::vector<double> value;
  int first_call{-1};  ///< number of the call that gave the first value
};

Integrated integrate(double rate_hz, Corner corner, double length_s,
                     const std::function<double(double)>& input) {
  DriftFreeIntegral filter{rate_hz};
  filter.set_corner(corner);
  Integrated out;
  const int count = static_cast<int>(length_s * rate_hz);
  for (int n = 0; n < count; ++n) {
    double value = 0.0;
    if (!filter.update(input(n / rate_hz), value)) continue;
    if (out.first_call < 0) out.first_call = n;
    out.time_s.push_back((n - filter.delay()) / rate_hz);
    out.value.push_back(value);
  }
  return out;
}

double worst_of(const std::vector<double>& x) {
  double worst = 0.0;
  for (const double v : x) worst = std::max(worst, std::abs(v));
  return worst;
}

/// Largest difference from sin(w t) when the derivative of sin(w t) goes in.
double sine_error(double rate_hz, Corner corner, double f_hz) {
  const double w = kTwoPi * f_hz;
  const Integrated out =
      integrate(rate_hz, corner, 20.0, [w](double t) { return w * std::cos(w * t); });
  double worst = 0.0;
  for (std::size_t i = 0; i < out.value.size(); ++i)
    worst = std::max(worst, std::abs(out.value[i] - std::sin(w * out.time_s[i])));
  return worst;
}

/// Gain at one frequency over an integrator's, by projection on the sine.
double gain(double rate_hz, Corner corner, double f_hz) {
  const double w = kTwoPi * f_hz;
  const Integrated out =
      integrate(rate_hz, corner, 60.0, [w](double t) { return w * std::cos(w * t); });
  double ss = 0.0, cc = 0.0, cs = 0.0, xs = 0.0, xc = 0.0;
  for (std::size_t i = 0; i < out.value.size(); ++i) {
    const double s = std::sin(w * out.time_s[i]);
    const double c = std::cos(w * out.time_s[i]);
    ss += s * s;
    cc += c * c;
    cs += c * s;
    xs += out.value[i] * s;
    xc += out.value[i] * c;
  }
  return (xs * cc - xc * cs) / (ss * cc - cs * cs);
}

class DriftFreeIntegralAtRates : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Rates, DriftFreeIntegralAtRates, testing::Values(150.0, 300.0, 400.0));

TEST_P(DriftFreeIntegralAtRates, AConstantGivesNothing) {
  for (const Corner corner : {Corner::k0p7Hz, Corner::k1p0Hz}) {
    const auto out = integrate(GetParam(), corner, 60.0, [](double) { return 10.0; });
    EXPECT_LT(worst_of(out.value), 1e-11);
  }
}

TEST_P(DriftFreeIntegralAtRates, AConstantOf1000StillGivesNothing) {
  for (const Corner corner : {Corner::k0p7Hz, Corner::k1p0Hz}) {
    const auto out = integrate(GetParam(), corner, 60.0, [](double) { return 1000.0; });
    EXPECT_LT(worst_of(out.value), 1e-9);
  }
}

// A ramp of the input is a parabola of its integral, of which a constant is left.
TEST_P(DriftFreeIntegralAtRates, ARampGivesAConstantOfAtMost3MillisecondsSquaredOfItsSlope) {
  for (const Corner corner : {Corner::k0p7Hz, Corner::k1p0Hz}) {
    const double slope = 1000.0 / 60.0;
    const auto out = integrate(GetParam(), corner, 60.0, [slope](double t) { return slope * t; });
    EXPECT_LT(worst_of(out.value), 3e-3 * slope);
    const auto [low, high] = std::minmax_element(out.value.begin(), out.value.end());
    EXPECT_LT(*high - *low, 1e-9);
  }
}

TEST_P(DriftFreeIntegralAtRates, ASineFrom2HzIsIntegratedInPhase) {
  // The short rule is good up to 0.27 of the rate.
  for (const double f_hz : steps(2.0, std::min(60.0, 0.27 * GetParam()), 1.0)) {
    EXPECT_LT(sine_error(GetParam(), Corner::k0p7Hz, f_hz), 5e-3) << f_hz << " Hz, corner 0.7";
    EXPECT_LT(sine_error(GetParam(), Corner::k1p0Hz, f_hz), 7e-3) << f_hz << " Hz, corner 1.0";
  }
}

TEST_P(DriftFreeIntegralAtRates, IsHalfAtTheCorner) {
  EXPECT_NEAR(gain(GetParam(), Corner::k0p7Hz, 0.7), 0.5, 0.04);
  EXPECT_NEAR(gain(GetParam(), Corner::k1p0Hz, 1.0), 0.5, 0.04);
}

TEST_P(DriftFreeIntegralAtRates, IsCloseToTheStatedResponseOnBothSidesOfTheCorner) {
  for (const Corner corner : {Corner::k0p7Hz, Corner::k1p0Hz}) {
    const double corner_hz = corner == Corner::k0p7Hz ? 0.7 : 1.0;
    for (const double relative : {0.15, 0.25, 0.6, 0.8, 1.2, 1.5, 2.0}) {
      const double p = std::pow(relative, 8);
      // The window of the 17 taps widens the edge: by 0.15 next to the corner, by 0.02 away from
      // it.
      const double tolerance = relative < 0.3 || relative > 1.9 ? 0.02 : 0.16;
      EXPECT_NEAR(gain(GetParam(), corner, relative * corner_hz), p / (1.0 + p), tolerance)
          << relative;
    }
  }
}

TEST_P(DriftFreeIntegralAtRates, LagsByLessThanTwoAndAHalfSeconds) {
  const DriftFreeIntegral filter{GetParam()};
  EXPECT_GT(filter.delay(), 0);
  EXPECT_LT(filter.delay() / GetParam(), 2.5);
}

TEST_P(DriftFreeIntegralAtRates, GivesItsFirstValueForTheSampleThatItSays) {
  const DriftFreeIntegral filter{GetParam()};
  const auto out = integrate(GetParam(), Corner::k0p7Hz, 20.0, [](double t) { return t; });
  EXPECT_EQ(out.first_call, filter.first() + filter.delay());
}

TEST_P(DriftFreeIntegralAtRates, ResetStartsClean) {
  DriftFreeIntegral used{GetParam()};
  DriftFreeIntegral fresh{GetParam()};
  double a = 0.0;
  double b = 0.0;
  for (int n = 0; n < 3333; ++n) static_cast<void>(used.update(500.0 + n, a));
  used.reset();
  std::mt19937_64 random{4};
  std::normal_distribution<double> noise;
  for (int n = 0; n < 4000; ++n) {
    const double x = noise(random);
    const bool had = used.update(x, a);
    ASSERT_EQ(had, fresh.update(x, b)) << n;
    if (had) {
      ASSERT_EQ(a, b) << n;
    }
  }
}

/// A bias makes the running integral cross the limit at which it is re-based, over and over.
TEST(DriftFreeIntegral, ReBasingDoesNotShow) {
  const auto motion = [](double t) {
    return std::cos(kTwoPi * 5.0 * t) + std::cos(kTwoPi * 23 * t);
  };
  const auto plain = integrate(300.0, Corner::k0p7Hz, 100.0, motion);
  const auto biased =
      integrate(300.0, Corner::k0p7Hz, 100.0, [&](double t) { return motion(t) + 30.0; });
  ASSERT_EQ(plain.value.size(), biased.value.size());
  for (std::size_t i = 0; i < plain.value.size(); ++i)
    ASSERT_NEAR(plain.value[i], biased.value[i], 1e-9);
}

TEST(DriftFreeIntegral, KeepsItsDigitsOverAnHourOfBias) {
  const auto out = integrate(300.0, Corner::k0p7Hz, 3600.0,
                             [](double t) { return 9.81 + std::cos(kTwoPi * 6.0 * t); });
  double worst = 0.0;
  for (std::size_t i = 0; i < out.value.size(); ++i) {
    const double w = kTwoPi * 6.0;
    worst = std::max(worst, std::abs(out.value[i] - std::sin(w * out.time_s[i]) / w));
  }
  EXPECT_LT(worst, 5e-3 / (kTwoPi * 6.0));
}

TEST(DriftFreeIntegral, VelocityIsTheRateOfTheDeflectionThatFollowsIt) {
  DriftFreeIntegral velocity{300.0};
  DriftFreeIntegral deflection{300.0};
  const int lag = deflection.delay();
  std::vector<double> v;
  std::vector<double> y;
  for (int n = 0; n < 9000; ++n) {
    const double t = n / 300.0;
    double now = 0.0;
    const double a = std::cos(kTwoPi * 3.1 * t) + 2.0 * std::cos(kTwoPi * 7.7 * t);
    if (!velocity.update(a, now)) continue;
    v.push_back(now);
    double then = 0.0;
    if (deflection.update(now, then)) y.push_back(then);
  }
  // Sample i of y belongs to sample v.size() - y.size() - lag + i of v.
  const std::size_t offset = v.size() - y.size() - static_cast<std::size_t>(lag);
  double error = 0.0;
  double total = 0.0;
  for (std::size_t i = 2; i + 2 < y.size(); ++i) {
    const double rate = 300.0 * (8.0 * (y[i + 1] - y[i - 1]) - (y[i + 2] - y[i - 2])) / 12.0;
    error += (rate - v[offset + i]) * (rate - v[offset + i]);
    total += v[offset + i] * v[offset + i];
  }
  ASSERT_GT(total, 0.0);
  EXPECT_LT(std::sqrt(error / total), 2e-3);
}

}  // namespace
}  // namespace dampline

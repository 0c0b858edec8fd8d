// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "dampline/motion/drift_free_integral.hpp"

namespace dampline {
namespace {

class BaselineOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Decimations, BaselineOf, testing::Values(25, 51, 69));

TEST_P(BaselineOf, RemovesConstantsAndRampsExactly) {
  Baseline baseline{GetParam()};
  int values = 0;
  for (int n = 0; n < 40 * GetParam(); ++n) {
    double out = 1.0;
    if (!baseline.update(7.0 - 0.01 * n, out)) continue;
    ++values;
    EXPECT_NEAR(out, 0.0, 1e-12) << n;
  }
  EXPECT_GT(values, 0);
}

TEST_P(BaselineOf, SaysItsDelayAndItsFirstValue) {
  Baseline baseline{GetParam()};
  for (int n = 0; n < 40 * GetParam(); ++n) {
    double out = 0.0;
    EXPECT_EQ(baseline.update(0.0, out), n >= baseline.first() + baseline.delay()) << n;
  }
  EXPECT_EQ(baseline.first(), (2 + 8 + 1) * GetParam()) << "two boxes, eight taps, the spline";
}

/// Fast parts pass: an alternating sign comes out as it went in, delay() samples late.
TEST_P(BaselineOf, PassesWhatIsFastAtItsDelay) {
  Baseline baseline{GetParam()};
  for (int n = 0; n < 40 * GetParam(); ++n) {
    double out = 0.0;
    if (!baseline.update(n % 2 == 0 ? 1.0 : -1.0, out)) continue;
    EXPECT_NEAR(out, (n - baseline.delay()) % 2 == 0 ? 1.0 : -1.0, 1e-3) << n;
  }
}

/// A pulse far from the ends gives the mirror image of itself: no phase error.
TEST_P(BaselineOf, IsSymmetricAroundAKnot) {
  Baseline baseline{GetParam()};
  const int centre = 30 * GetParam();
  std::vector<double> response(static_cast<std::size_t>(2 * centre), 0.0);
  for (int n = 0; n < 2 * centre + baseline.delay(); ++n) {
    double out = 0.0;
    const bool ready = baseline.update(n == centre ? 1.0 : 0.0, out);
    if (ready && n - baseline.delay() < 2 * centre)
      response[static_cast<std::size_t>(n - baseline.delay())] = out;
  }
  for (int i = 1; i < 15 * GetParam(); ++i) {
    EXPECT_NEAR(response[static_cast<std::size_t>(centre + i)],
                response[static_cast<std::size_t>(centre - i)], 1e-16);
  }
}

/// What is left of a pulse is the pulse less the spline through the filtered boxes around it, all
/// from their definitions; `taps` of the middle and of one side.
std::vector<double> response_of(const std::vector<double>& taps, int decimation, int reach) {
  std::vector<double> box{1.0};  // three boxes, one after the other
  for (int round = 0; round < 3; ++round) {
    std::vector<double> next(box.size() + static_cast<std::size_t>(decimation) - 1, 0.0);
    for (std::size_t i = 0; i < box.size(); ++i)
      for (std::size_t j = 0; j < static_cast<std::size_t>(decimation); ++j)
        next[i + j] += box[i] / decimation;
    box = next;
  }
  const auto boxed = [&](int from) {  // at a distance from the middle
    const int at = from + static_cast<int>(box.size()) / 2;
    return at < 0 || at >= static_cast<int>(box.size()) ? 0.0 : box[static_cast<std::size_t>(at)];
  };
  const auto spline = [](double x) {
    const double u = std::abs(x);
    if (u >= 2.0) return 0.0;
    return u < 1.0 ? 2.0 / 3.0 - u * u + 0.5 * u * u * u : std::pow(2.0 - u, 3) / 6.0;
  };
  std::vector<double> out;
  for (int n = -reach; n <= reach; ++n) {
    double slow = 0.0;
    const int knot = static_cast<int>(std::floor(static_cast<double>(n) / decimation));
    for (int i = knot - 2; i <= knot + 3; ++i) {
      double filtered = 0.0;
      for (int j = -8; j <= 8; ++j)
        filtered += taps[static_cast<std::size_t>(std::abs(j))] * boxed((i - j) * decimation);
      slow += filtered * spline(static_cast<double>(n) / decimation - i);
    }
    out.push_back((n == 0 ? 1.0 : 0.0) - slow);
  }
  return out;
}

/// The taps by their definition: the inverse transform of 1 / (1 + (f / corner)^8) over the boxes'
/// and the spline's responses, under the root of Hann's window, of unit sum; of 51 at 300 Hz.
std::vector<double> taps_of(double corner_hz) {
  constexpr double kLowHz = 300.0 / 51.0;
  std::vector<double> taps(9, 0.0);
  constexpr int kSteps = 20000;
  for (int s = 0; s < kSteps; ++s) {
    const double f = 0.5 * (s + 0.5) / kSteps;  // of the low rate
    const double sinc = std::sin(M_PI * f) / (M_PI * f);
    const double boxes = std::pow(std::sin(M_PI * f) / (51.0 * std::sin(M_PI * f / 51.0)), 3);
    const double wanted = 1.0 / (1.0 + std::pow(f * kLowHz / corner_hz, 8));
    for (std::size_t j = 0; j < taps.size(); ++j)
      taps[j] +=
          wanted / (boxes * std::pow(sinc, 4)) * std::cos(2.0 * M_PI * f * static_cast<double>(j));
  }
  double sum = 0.0;
  for (std::size_t j = 0; j < taps.size(); ++j) {
    taps[j] *= std::cos(M_PI * static_cast<double>(j) / 18.0);
    sum += (j == 0 ? 1.0 : 2.0) * taps[j];
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

TEST_P(BaselineOf, IsThePulseLessBoxesTapsAndSpline) {
  for (const auto corner : {Baseline::Corner::k0p7Hz, Baseline::Corner::k1p0Hz}) {
    const int reach = 13 * GetParam();
    const auto expected =
        response_of(taps_of(corner == Baseline::Corner::k0p7Hz ? 0.7 : 1.0), GetParam(), reach);
    Baseline baseline{GetParam()};
    baseline.set_corner(corner);
    EXPECT_EQ(baseline.corner(), corner);
    const int pulse = 30 * GetParam();  // on a knot
    int compared = 0;
    for (int n = 0; n < pulse + reach + baseline.delay(); ++n) {
      double out = 0.0;
      if (!baseline.update(n == pulse ? 1.0 : 0.0, out)) continue;
      const int away = n - baseline.delay() - pulse;
      if (std::abs(away) > reach) continue;
      EXPECT_NEAR(out, expected[static_cast<std::size_t>(away + reach)], 1e-4) << away;
      ++compared;
    }
    EXPECT_EQ(compared, 2 * reach);
  }
}

TEST_P(BaselineOf, ReBasingDoesNotChangeTheOutput) {
  Baseline plain{GetParam()};
  Baseline rebased{GetParam()};
  std::mt19937_64 random{2};
  std::normal_distribution<double> noise;
  double base = 0.0;
  for (int n = 0; n < 4000; ++n) {
    const double x = noise(random);
    double a = 0.0;
    double b = 0.0;
    const bool had = plain.update(x, a);
    ASSERT_EQ(rebased.update(x - base, b), had);
    if (had) {
      ASSERT_NEAR(a, b, 1e-9);
    }
    if (n % 333 == 100) {
      rebased.rebase(1000.0);
      base += 1000.0;
    }
  }
}

TEST(Baseline, TheTwoCornersDiffer) {
  Baseline low{51};
  Baseline high{51};
  high.set_corner(Baseline::Corner::k1p0Hz);
  double difference = 0.0;
  for (int n = 0; n < 4000; ++n) {
    double a = 0.0;
    double b = 0.0;
    const double x = std::sin(2.0 * 3.14159 * 0.85 * n / 300.0);
    if (low.update(x, a) && high.update(x, b)) difference = std::max(difference, std::abs(a - b));
  }
  EXPECT_GT(difference, 0.3);
}

}  // namespace
}  // namespace dampline

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

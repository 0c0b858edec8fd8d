// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "dampline/basis/columns.hpp"
#include "dampline/damping/estimator.hpp"
#include "tests/steps.hpp"

namespace dampline {
namespace {

const LawColumns law_columns{kDefaultCurveNodesMps};

TEST(LawColumns, BeginWithASmoothSignOfEachWidth) {
  for (const double v : steps(-0.05, 0.05, 0.37e-3)) {
    const auto values = law_columns(v);
    for (std::size_t i = 0; i < kLawWidths; ++i) {
      EXPECT_NEAR(values[static_cast<int>(i)],
                  std::erf(0.5 * std::sqrt(std::acos(-1.0)) * v / kLawWidthMps[i]), 3e-6);
    }
  }
}

TEST(LawColumns, EndWithTheRampsOfABrokenLine) {
  for (const double v : steps(-0.1, 0.1, 0.41e-3)) {
    const auto values = law_columns(v);
    double left = 0.0;
    for (std::size_t i = 0; i < kCurveSegments; ++i) {
      const double right = i + 1 < kCurveSegments ? kDefaultCurveNodesMps[i] : 1e9;
      double ramp = 0.0;
      if (std::abs(v) >= right) {
        ramp = right - left;
      } else if (std::abs(v) > left) {
        ramp = std::abs(v) - left;
      }
      EXPECT_NEAR(values[static_cast<int>(kLawWidths + i)], v < 0.0 ? -ramp : ramp, 6e-9);
      left = kDefaultCurveNodesMps[i];
    }
  }
}

TEST(LawColumns, TheRampsTogetherAreTheVelocity) {
  for (const double v : {-0.2, -0.039, -0.001, 0.0, 0.0007, 0.012, 0.041, 0.5})
    EXPECT_NEAR(law_columns(v).tail<static_cast<int>(kCurveSegments)>().sum(), v,
                1e-7 * std::abs(v) + 1e-12);
}

TEST(LawColumns, AreOdd) {
  for (const double v : steps(0.0, 0.1, 0.37e-3))
    EXPECT_EQ((law_columns(v) + law_columns(-v)).cwiseAbs().maxCoeff(), 0.0) << v;
}

// Statistics of other years merge with today's only where these are the same.
TEST(LawColumns, SegmentsAndWidthsAreThoseOfEveryState) {
  EXPECT_EQ(kDefaultCurveNodesMps,
            (CurveNodes{0.003, 0.0055, 0.008, 0.011, 0.0145, 0.019, 0.026, 0.040}));
  EXPECT_EQ(kLawWidthMps, (std::array{0.0005, 0.0007, 0.001, 0.0014, 0.002, 0.0028, 0.004, 0.0056,
                                      0.008, 0.011}));
}

// As state_format.md says: ten widths, eight ramps, spring, damping and target.
TEST(LawColumns, AreFollowedByThreeOthersInARow) {
  EXPECT_EQ(static_cast<int>(LawColumns::kCount), 18);
  EXPECT_EQ(kRowColumns, 21);
}

TEST(LawColumns, TheWidthsIncrease) {
  for (std::size_t i = 1; i < kLawWidths; ++i) EXPECT_GT(kLawWidthMps[i], kLawWidthMps[i - 1]);
}

}  // namespace
}  // namespace dampline

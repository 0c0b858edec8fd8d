// SPDX-License-Identifier: MIT
#include "dampline/density/joint_histogram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "sim_hw/noise.hpp"

namespace dampline {
namespace {

using Joint = JointHistogram<16, 32>;

JointHistogramConfig given(double memory = 0.0) {
  return {
      .x = {.low = -2.0, .high = 2.0}, .y = {.low = -4.0, .high = 4.0}, .memory_samples = memory};
}

/// Correlated normal numbers.
void fill(Joint& joint, double correlation, int count, std::uint64_t seed) {
  sim::Random random{seed, sim::Stream::kTrack};
  for (int i = 0; i < count; ++i) {
    const double x = random.normal();
    joint.update(x, correlation * x + std::sqrt(1.0 - correlation * correlation) * random.normal());
  }
}

double integral(const Joint& joint) {
  double sum = joint.share_outside();
  for (std::size_t i = 0; i < 16; ++i) {
    for (std::size_t j = 0; j < 32; ++j) {
      sum += joint.density(i, j) * joint.x_axis().width() * joint.y_axis().width();
    }
  }
  return sum;
}

TEST(JointHistogram, ChecksItsConfiguration) {
  EXPECT_TRUE(Joint::check(given()).ok());
  auto wrong = given();
  wrong.y.low = 5.0;
  EXPECT_FALSE(Joint::check(wrong).ok());
  EXPECT_FALSE(Joint::check(given(-1.0)).ok());
}

TEST(JointHistogram, IntegratesToOneWithTheMassOutside) {
  for (const double memory : {0.0, 900.0}) {
    Joint joint{given(memory)};
    fill(joint, 0.5, 100'000, 1);
    joint.update(std::numeric_limits<double>::quiet_NaN(), 0.0);
    EXPECT_GT(joint.share_outside(), 0.03);
    EXPECT_EQ(joint.not_finite(), 1U);
    EXPECT_NEAR(integral(joint), 1.0, 1e-12);
  }
}

TEST(JointHistogram, TwoHalvesMergeToTheWholeExactly) {
  Joint whole{given()};
  Joint first{given()};
  Joint second{given()};
  sim::Random random{7, sim::Stream::kTrack};
  for (int i = 0; i < 30'000; ++i) {
    const double x = random.normal();
    const double y = random.normal();
    whole.update(x, y);
    (i % 3 == 0 ? first : second).update(x, y);
  }
  first.update(std::numeric_limits<double>::quiet_NaN(), 0.0);
  second.update(0.0, std::numeric_limits<double>::infinity());
  ASSERT_TRUE(first.merge(second).ok());
  EXPECT_EQ(first.not_finite(), 2U);
  EXPECT_EQ(first.share_outside(), whole.share_outside());
  for (std::size_t i = 0; i < 16; ++i) {
    for (std::size_t j = 0; j < 32; ++j) EXPECT_EQ(first.share(i, j), whole.share(i, j));
  }
  auto other = given();
  other.x.high = 3.0;
  const auto refused = first.merge(Joint{other});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error(), Errc::kMismatch);
}

// The weights are scaled back every 208 memories; what lies outside is forgotten with the rest.
TEST(JointHistogram, ForgetsAlikeForever) {
  Joint joint{given(10.0)};
  for (int i = 0; i < 30'000; ++i) {
    if (i % 3 == 0) joint.update(0.1, 0.1);
    if (i % 3 == 1) joint.update(9.0, 0.1);
    if (i % 3 == 2) joint.update(-0.1, 0.1);
  }
  const double older = std::exp(-0.1);
  const double all = 1.0 + older + older * older;
  EXPECT_NEAR(joint.share(7, 16), 1.0 / all, 1e-9);
  EXPECT_NEAR(joint.share_outside(), older / all, 1e-9);
  EXPECT_NEAR(joint.share(8, 16), older * older / all, 1e-9);
}

// Both are seen at their own newest sample.
TEST(JointHistogram, MergesWhatForgetsEitherWay) {
  Joint brief{given(100.0)};
  Joint lasting{given(100.0)};
  fill(brief, 0.3, 150, 5);
  fill(lasting, -0.3, 2000, 6);
  Joint other = lasting;
  ASSERT_TRUE(other.merge(brief).ok());
  ASSERT_TRUE(brief.merge(lasting).ok());
  EXPECT_EQ(brief.samples(), 2150U);
  EXPECT_NEAR(integral(brief), 1.0, 1e-12);
  EXPECT_NEAR(brief.share_outside(), other.share_outside(), 1e-12);
  for (std::size_t i = 0; i < 16; ++i)
    for (std::size_t j = 0; j < 32; ++j) EXPECT_NEAR(brief.share(i, j), other.share(i, j), 1e-12);
}

TEST(JointHistogram, PutsASampleWhereItBelongs) {
  Joint joint{given()};
  EXPECT_EQ(joint.share_outside(), 0.0) << "of nothing";
  EXPECT_EQ(joint.share(0, 0), 0.0);
  for (const auto& [x, y, i, j] :
       {std::tuple{-2.0, -4.0, 0U, 0U}, std::tuple{1.99, 3.99, 15U, 31U},
        std::tuple{0.0, -0.01, 8U, 15U}, std::tuple{-0.3, 0.0, 6U, 16U}}) {
    joint.update(x, y);
    EXPECT_GT(joint.share(i, j), 0.0) << x << " " << y;
  }
  for (const auto& [x, y] : {std::pair{2.0, 0.0}, {-2.01, 0.0}, {0.0, 4.0}, {0.0, -4.01}})
    joint.update(x, y);
  EXPECT_EQ(joint.share_outside(), 0.5);
  EXPECT_EQ(joint.samples(), 8U);
}

TEST(JointHistogram, LearnsBothRanges) {
  Joint learner{{.x = {.resolution = 1e-5, .warm_up_samples = 2'000},
                 .y = {.resolution = 1e-3, .warm_up_samples = 2'000}}};
  fill(learner, 0.3, 6'000, 9);
  Joint known{{.x = {.low = learner.x_axis().low(), .high = learner.x_axis().high()},
               .y = {.low = learner.y_axis().low(), .high = learner.y_axis().high()}}};
  fill(known, 0.3, 6'000, 9);
  EXPECT_GT(learner.x_axis().high(), 3.0);
  for (const auto& [x, y] : {std::pair{1e3, 0.0}, {0.0, 1e3}}) {
    const double outside = learner.share_outside();
    learner.update(x, y);
    known.update(x, y);
    EXPECT_GT(learner.share_outside(), outside) << "after the warm-up a range is fixed";
  }
  for (std::size_t i = 0; i < 16; ++i) {
    for (std::size_t j = 0; j < 32; ++j) EXPECT_EQ(learner.share(i, j), known.share(i, j));
  }
}

// Of independent numbers nothing is left above chance; of a bivariate normal distribution the mean
// square contingency is r^2 / (1 - r^2) (Pearson 1904), less what the range and the bins cut off.
TEST(Dependence, IsThatOfCorrelatedNumbers) {
  Joint independent{given()};
  fill(independent, 0.0, 40'000, 11);
  const Dependence none = dependence(independent, 40'000.0);
  ASSERT_TRUE(none.known);
  EXPECT_LT(none.size, 0.04);
  Joint dependent{{.x = {.low = -4.0, .high = 4.0}, .y = {.low = -4.0, .high = 4.0}}};
  fill(dependent, 0.4, 400'000, 12);
  const Dependence some = dependence(dependent, 400'000.0);
  ASSERT_TRUE(some.known);
  EXPECT_NEAR(some.size, 0.4 / std::sqrt(1.0 - 0.16), 0.04);
}

/// Three by three cells, each row and column a third, with so much on the diagonal beyond a ninth.
Joint three_by_three(int on_diagonal, int beside, int columns = 3) {
  Joint joint{given()};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < columns; ++j)
      for (int n = i == j ? on_diagonal : beside; n > 0; --n)
        joint.update(0.5 * i - 0.4, 0.5 * j - 0.4);
  return joint;
}

// sum (o - e)^2 / e over nine cells of a ninth, less nine over the independent samples.
TEST(Dependence, IsChiSquaresRootAboveChance) {
  const Joint joint = three_by_three(20, 10);
  const double excess = 20.0 / 120.0 - 1.0 / 9.0;
  const double lack = 10.0 / 120.0 - 1.0 / 9.0;
  const double chi2 = 9.0 * (3.0 * excess * excess + 6.0 * lack * lack);
  EXPECT_NEAR(dependence(joint, 1e4).size, std::sqrt(chi2 - 9.0 / 1e4), 1e-12);
  EXPECT_NEAR(dependence(joint, 120.0).size, std::sqrt(std::max(chi2 - 9.0 / 120.0, 0.0)), 1e-12);
  EXPECT_EQ(dependence(three_by_three(10, 10), 1e4).size, 0.0);
}

// Nine cells, in which five are expected.
TEST(Dependence, IsKnownFromNineCellsOfFiveOn) {
  EXPECT_TRUE(dependence(three_by_three(10, 10), 45.1).known);
  EXPECT_FALSE(dependence(three_by_three(10, 10), 44.9).known);
  EXPECT_FALSE(dependence(three_by_three(10, 10, 2), 1e6).known) << "six";
}

TEST(Dependence, IsUnknownOfFewSamples) {
  Joint joint{given()};
  fill(joint, 0.0, 40, 13);
  EXPECT_FALSE(dependence(joint, 40.0).known);
}

}  // namespace
}  // namespace dampline

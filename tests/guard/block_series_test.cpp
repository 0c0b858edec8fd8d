// SPDX-License-Identifier: MIT
#include "dampline/guard/block_series.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

namespace dampline {
namespace {

/// Ticks are ten apart.
BlockSeries series_of(std::initializer_list<double> values) {
  BlockSeries series;
  for (const double value : values)
    series.add(value, static_cast<std::int64_t>(series.size()) * 10);
  return series;
}

/// Deviation that a median squared first difference stands for.
double scatter_of(double median_square) { return std::sqrt(median_square / 0.4549 / 2.0); }

TEST(BlockSeries, KeepsTheNewestSixty) {
  BlockSeries series;
  for (int i = 0; i < 70; ++i) series.add(i, 100 + i);
  EXPECT_EQ(series.size(), 60U);
  EXPECT_EQ(series[0], 10.0);
  EXPECT_EQ(series.tick(0), 110);
  EXPECT_EQ(series.back(), 69.0);
  EXPECT_EQ(series.tick(59), 169);
  EXPECT_EQ(series.median(), 40.0);
  EXPECT_EQ(series.mean(), 39.5);
  EXPECT_EQ(series.range(), 59.0);
}

TEST(BlockSeries, ForgetsTheOldestByNumberOrByTick) {
  BlockSeries series = series_of({5.0, 6.0, 7.0, 8.0, 9.0});
  series.drop(2);
  EXPECT_EQ(series.size(), 3U);
  EXPECT_EQ(series[0], 7.0);
  EXPECT_EQ(series.tick(2), 40);
  series.drop_before(30);
  EXPECT_EQ(series.size(), 2U) << "what has that very tick stays";
  EXPECT_EQ(series[0], 8.0);
  series.drop_before(31);
  EXPECT_EQ(series[0], 9.0);
  series.drop(5);
  EXPECT_EQ(series.size(), 0U);
  BlockSeries full;
  for (int i = 0; i < 60; ++i) full.add(i, i);
  full.drop_before(1000);
  EXPECT_EQ(full.size(), 0U) << "all of them";
}

TEST(BlockSeries, OfNothingIsNothing) {
  BlockSeries series = series_of({3.0, 4.0});
  series.clear();
  EXPECT_EQ(series.size(), 0U);
  EXPECT_EQ(series.mean(), 0.0);
  EXPECT_EQ(series.median(), 0.0);
  EXPECT_EQ(series.range(), 0.0);
  EXPECT_EQ(series.scatter(), 0.0);
  EXPECT_EQ(series.step().significance, 0.0);
  EXPECT_EQ(series.change_at(0), 0.0);
  EXPECT_EQ(series.change_since(0), 0.0);
}

TEST(BlockSeries, ScatterIsTheMedianOfTheFirstDifferences) {
  EXPECT_EQ(series_of({7.0}).scatter(), 0.0);
  EXPECT_NEAR(series_of({7.0, 9.0}).scatter(), scatter_of(4.0), 1e-12);
  EXPECT_NEAR(series_of({0.0, 1.0, 3.0, 6.0}).scatter(), scatter_of(4.0), 1e-12);
  EXPECT_NEAR(series_of({0.0, 3.0, 2.0, 4.0, 0.0, 5.0}).scatter(), scatter_of(9.0), 1e-12);
}

TEST(BlockSeries, MedianIsTheMiddleOne) {
  EXPECT_EQ(series_of({5.0, 1.0, 3.0}).median(), 3.0);
  EXPECT_EQ(series_of({-4.0, 9.0, 2.0, 8.0, 7.0}).median(), 7.0);
}

TEST(BlockSeries, TheNewestAreTheLastOrAll) {
  const BlockSeries series = series_of({1.0, 2.0, 3.0, 4.0});
  EXPECT_EQ(series.newest(3).size(), 3U);
  EXPECT_EQ(series.newest(3)[0], 2.0);
  EXPECT_EQ(series.newest(3).tick(0), 10);
  EXPECT_EQ(series.newest(9).size(), 4U);
  EXPECT_EQ(series.newest(9)[0], 1.0);
  EXPECT_EQ(series.newest(4).mean(), 2.5);
}

// The means on either side over the deviation of their difference.
TEST(BlockSeries, AStepIsTheDifferenceOfMeansInItsDeviations) {
  const BlockSeries::Step step = series_of({0, 1, 0, 1, 8, 9, 8, 9, 8}).step();
  EXPECT_EQ(step.block, 4U);
  EXPECT_NEAR(step.size, 8.4 - 0.5, 1e-12);
  EXPECT_NEAR(step.significance, 7.9 / (scatter_of(1.0) * std::sqrt(1.0 / 4.0 + 1.0 / 5.0)), 1e-9);
  const BlockSeries::Step down = series_of({9, 8, 9, 1, 0, 1, 0}).step();
  EXPECT_EQ(down.block, 3U);
  EXPECT_NEAR(down.size, 0.5 - 26.0 / 3.0, 1e-12);
  EXPECT_GT(down.significance, 0.0);
}

TEST(BlockSeries, AStepHasThreeBlocksOnEitherSide) {
  EXPECT_EQ(series_of({0, 1, 0, 8, 9}).step().significance, 0.0);
  EXPECT_EQ(series_of({0, 1, 0, 8, 9, 8}).step().block, 3U);
  EXPECT_EQ(series_of({0, 1, 0, 1, 0, 1, 8, 9}).step().block, 5U) << "two blocks are too few";
  EXPECT_EQ(series_of({8, 9, 0, 1, 0, 1, 0, 1}).step().block, 3U);
}

TEST(BlockSeries, AStepWithoutScatterIsAsSureAsCanBe) {
  const BlockSeries::Step step = series_of({1, 1, 1, 2, 2, 2}).step();
  EXPECT_EQ(step.block, 3U);
  EXPECT_EQ(step.size, 1.0);
  EXPECT_GT(step.significance, 1e300);
}

TEST(BlockSeries, ChangeAtLooksAtThreeBlocksAndLeavesTheNearestOut) {
  const BlockSeries series = series_of({100, 1, 2, 3, 50, 60, 5, 6, 8, 200});
  EXPECT_NEAR(series.change_at(50), 19.0 / 3.0 - 2.0, 1e-12);
  EXPECT_NEAR(series.change_at(20), 113.0 / 3.0 - 100.0, 1e-12) << "one block before is left";
  EXPECT_NEAR(series.change_at(80), 200.0 - 115.0 / 3.0, 1e-12) << "one block after is left";
  EXPECT_EQ(series.change_at(10), 0.0);
  EXPECT_EQ(series.change_at(90), 0.0);
}

TEST(BlockSeries, ChangeSinceComparesTwoAndTwo) {
  const BlockSeries series = series_of({7, 1, 2, 5, 9});
  EXPECT_EQ(series.change_since(10), 7.0 - 1.5);
  EXPECT_EQ(series.change_since(0), 7.0 - 4.0);
  EXPECT_EQ(series.change_since(11), 0.0);
}

TEST(BlockSeries, ATrendNeedsSixBlocks) {
  EXPECT_EQ(series_of({0, 1, 2, 3, 4}).trend().per_block, 0.0);
  const BlockSeries::Trend straight = series_of({0, 1, 2, 3, 4, 5}).trend();
  EXPECT_NEAR(straight.per_block, 1.0, 1e-12);
  EXPECT_NEAR(straight.total, 5.0, 1e-12);
  EXPECT_NEAR(straight.significance, std::sqrt(17.5) / scatter_of(1.0), 1e-9);
}

TEST(BlockSeries, ALineIsNoStep) {
  for (const std::size_t block : {3U, 4U}) {
    EXPECT_TRUE(series_of({0, 1, 2, 3, 4, 5, 6}).is_straight(block));
    EXPECT_TRUE(series_of({0.1, -1, -2.1, -3, -3.9, -5, -6.1}).is_straight(block));
  }
  for (const double within : {0.0, 0.3, 0.5, 1.0}) {  // of the change, in the block that holds it
    EXPECT_FALSE(series_of({0, 0, 0, within, 1, 1, 1}).is_straight(3));
    EXPECT_FALSE(series_of({0, 0.02, 0, -0.01, within, 1, 1.02, 0.99}).is_straight(4));
    EXPECT_FALSE(series_of({0, 0, 0, 0, 0, within, -1, -1, -1}).is_straight(6));
  }
  EXPECT_TRUE(series_of({0, 0, 1, 1}).is_straight(1)) << "one block is no level";
}

}  // namespace
}  // namespace dampline

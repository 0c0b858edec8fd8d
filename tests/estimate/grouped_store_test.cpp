// SPDX-License-Identifier: MIT
#include "dampline/estimate/grouped_store.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>

#include "tests/estimate/random_rows.hpp"

namespace dampline {
namespace {

constexpr int kSteps = 200;  // in which a block has to be taken in

std::unique_ptr<GroupedStore> fed(const std::vector<PlainRow>& rows,
                                  const MemoryConfig& config = {}) {
  auto store = std::make_unique<GroupedStore>(config);
  feed(*store, rows, kSteps);
  return store;
}

TEST(GroupedStore, TheTotalEqualsTheBatch) {
  const auto rows = random_rows(100, 30, 1);
  fed(rows)->summed_up([&](const ScaleFactors& total, GroupedList /*entries*/) {
    for (std::size_t s = 0; s < kScales; ++s)
      EXPECT_LT(relative_difference(total.factor[s].gram(),
                                    batch_gram(rows, s, [](std::int64_t) { return 1.0; })),
                1e-12);
    EXPECT_EQ(total.blocks, 100U);
  });
}

TEST(GroupedStore, AnOldBlockWeighsExponentiallyLessInTheTotal) {
  const auto rows = random_rows(60, 30, 2);
  const MemoryConfig config{.memory = Memory::kForgetting, .memory_blocks = 10.0};
  fed(rows, config)->summed_up([&](const ScaleFactors& total, GroupedList /*entries*/) {
    // A block is weighed when it closes, the newest too.
    const auto weight = [](std::int64_t b) {
      return std::exp(-static_cast<double>(60 - b) / 10.0);
    };
    EXPECT_LT(relative_difference(total.factor[0].gram(), batch_gram(rows, 0, weight)), 1e-12);
  });
}

TEST(GroupedStore, EntriesHoldEveryBlockWhoseWeightsWereKnownOverManyJoins) {
  const auto rows = random_rows(333, 20, 3);
  fed(rows)->summed_up([](const ScaleFactors& total, GroupedList entries) {
    std::uint32_t blocks = 0;
    for (const GroupedFactors* entry : entries) blocks += entry->blocks;
    EXPECT_EQ(total.blocks, 333U);
    EXPECT_EQ(blocks, 332U);  // when the first began, no scale had shown its rows
    EXPECT_GE(entries.size(), GroupedStore::kMostEntries / 2);
    EXPECT_LE(entries.size(), GroupedStore::kMostEntries);
  });
}

// Every column and the target are white and of unit variance: a weighed row leaves 1 of its target.
// The second block's weights are guesses, for other records than this one.
TEST(GroupedStore, WeighedRowsLeaveUnitResiduals) {
  const auto rows = random_rows(200, 30, 4);
  fed(rows)->summed_up([](const ScaleFactors& /*total*/, GroupedList entries) {
    for (std::size_t g = 0; g < kGroups; ++g) {
      GroupedFactors::Factor sum;
      std::uint32_t blocks = 0;
      for (const GroupedFactors* entry : entries.subspan(1)) {
        sum.merge(entry->factor[g]);
        blocks += entry->blocks;
      }
      const double count = (g == 0 ? 4.0 : 1.0) * 30.0 * blocks;
      EXPECT_NEAR(sum.residual_norm() * sum.residual_norm() / count, 1.0, 0.05);
    }
  });
}

TEST(GroupedStore, ClearForgetsAllThatWasMerged) {
  const auto rows = random_rows(100, 20, 5);
  GroupedStore store{MemoryConfig{}};
  feed(store, rows, 0);
  store.clear();
  EXPECT_EQ(store.blocks_per_entry(), 1U) << "as in a new run";
  store.summed_up([](const ScaleFactors& total, GroupedList entries) {
    EXPECT_EQ(total.blocks, 0U);
    EXPECT_EQ(entries.size(), 0U);
    for (std::size_t s = 0; s < kScales; ++s) EXPECT_EQ(total.rows[s], 0.0);
  });
  feed(store, rows, kSteps);
  store.summed_up([&](const ScaleFactors& total, GroupedList /*entries*/) {
    EXPECT_EQ(total.blocks, 100U);
    EXPECT_LT(relative_difference(total.factor[1].gram(),
                                  batch_gram(rows, 1, [](std::int64_t) { return 1.0; })),
              1e-12);
  });
}

/// Blocks of so many rows of each scale, all of whose columns are white and whose target is +-1.
std::vector<PlainRow> rows_of_unit_targets(std::int64_t blocks, int rows_per_scale) {
  auto rows = random_rows(blocks, rows_per_scale, 6);
  for (PlainRow& r : rows) r.row[kTargetColumn] = r.row[kTargetColumn] > 0.0 ? 1.0 : -1.0;
  return rows;
}

TEST(GroupedStore, WeighsABlockWhenEightRowsOfEachScaleCameBefore) {
  for (const auto& [rows, blocks] : {std::pair{7, 1U}, std::pair{8, 2U}})
    fed(rows_of_unit_targets(3, rows))
        ->summed_up([blocks = blocks](const ScaleFactors& /*total*/, GroupedList entries) {
          std::uint32_t held = 0;
          for (const GroupedFactors* entry : entries) held += entry->blocks;
          EXPECT_EQ(held, blocks);
        });
}

// Where the rows are too few to tell: a row leaves a fiftieth of its target's power, which
// becomes 1.
TEST(GroupedStore, GuessesAFiftiethWhereRowsAreTooFew) {
  fed(rows_of_unit_targets(2, 10))
      ->summed_up([](const ScaleFactors& /*total*/, GroupedList entries) {
        ASSERT_EQ(entries.size(), 1U);
        for (std::size_t g = 0; g < kGroups; ++g) {
          const double count = (g == 0 ? 4.0 : 1.0) * 10.0;
          const double target = entries[0]->factor[g].column_norm(kTargetColumn);
          EXPECT_NEAR(target * target / count, 50.0, 1e-3);
        }
      });
}

}  // namespace
}  // namespace dampline

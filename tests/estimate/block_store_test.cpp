// SPDX-License-Identifier: MIT
#include "dampline/estimate/block_store.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

#include "tests/estimate/random_rows.hpp"

namespace dampline {
namespace {

constexpr int kMany = 2000;  // steps that finish any pending work

std::unique_ptr<BlockStore> store_with(const BlockStore::Config& config) {
  return std::make_unique<BlockStore>(config);
}

double worst_difference(const BlockStore& store, const std::vector<PlainRow>& rows,
                        const auto& weight) {
  const auto total = std::make_unique<ScaleFactors>();
  store.total_to(*total);
  double worst = 0.0;
  for (std::size_t s = 0; s < kScales; ++s) {
    const RowGram truth = batch_gram(rows, s, weight);
    worst = std::max(worst, relative_difference(total->factor[s].gram(), truth));
  }
  return worst;
}

std::vector<ScaleFactors> entries_of(const BlockStore& store) {
  std::array<const ScaleFactors*, kEntries> pointers{};
  const std::size_t count = store.entries_to(pointers);
  std::vector<ScaleFactors> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(*pointers[i]);
  return out;
}

TEST(BlockStore, RecursiveEqualsBatch) {
  const auto rows = random_rows(100, 30, 1);
  const auto store = store_with({});
  feed(*store, rows, kMany);
  EXPECT_LT(worst_difference(*store, rows, [](std::int64_t) { return 1.0; }), 1e-12);
}

TEST(BlockStore, AWindowHoldsTheRowsOfItsLastBlocksAndNoOthers) {
  // 28 entries of two blocks.
  const auto rows = random_rows(150, 20, 2);
  const auto store = store_with({.memory = Memory::kWindow, .memory_blocks = 56.0});
  feed(*store, rows, kMany);
  EXPECT_EQ(store->blocks_per_entry(), 2U);
  EXPECT_LT(
      worst_difference(*store, rows, [](std::int64_t b) { return b >= 150 - 56 ? 1.0 : 0.0; }),
      1e-10);
}

/// Any length, also one that is not a multiple of the number of entries.
class BlockStoreWindow : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Lengths, BlockStoreWindow, testing::Values(1, 10, 27, 28, 30, 57, 200));

TEST_P(BlockStoreWindow, HoldsAsManyBlocksAsItIsLongWithinOneEntry) {
  const auto store =
      store_with({.memory = Memory::kWindow, .memory_blocks = static_cast<double>(GetParam())});
  feed(*store, random_rows(600, 1, 3), kMany);
  const auto total = std::make_unique<ScaleFactors>();
  store->total_to(*total);
  EXPECT_NEAR(total->blocks, GetParam(), store->blocks_per_entry() - 1);
}

TEST(BlockStore, ForgettingIsAnExponentialWeightByTheAgeInBlocks) {
  const auto rows = random_rows(100, 20, 4);
  const auto store = store_with({.memory = Memory::kForgetting, .memory_blocks = 12.5});
  feed(*store, rows, kMany);
  EXPECT_LT(worst_difference(
                *store, rows,
                [](std::int64_t b) { return std::exp(-static_cast<double>(99 - b) / 12.5); }),
            1e-12);
  const auto total = std::make_unique<ScaleFactors>();
  store->total_to(*total);
  EXPECT_NEAR(total->rows[0],
              20.0 * (1.0 - std::exp(-100.0 / 12.5)) / (1.0 - std::exp(-1.0 / 12.5)), 1e-9);
}

// An hour's time constant once made entries of six minutes from the start, and no estimate before
// there were some.
TEST(BlockStore, ALongMemoryBeginsWithShortEntries) {
  for (const Memory memory : {Memory::kForgetting, Memory::kWindow}) {
    const auto store = store_with({.memory = memory, .memory_blocks = 1800.0});
    feed(*store, random_rows(20, 1, 9), kMany);
    EXPECT_EQ(entries_of(*store).size(), 20U);
    feed(*store, random_rows(5000, 1, 9), kMany);
    const double covered = memory == Memory::kWindow ? 1800.0 : 5000.0;
    double blocks = 0.0;
    for (const ScaleFactors& entry : entries_of(*store)) blocks += entry.blocks;
    EXPECT_NEAR(blocks, covered, store->blocks_per_entry());
    EXPECT_GE(entries_of(*store).size(), kEntries / 2);
  }
}

TEST(BlockStore, NothingIsForgottenWithoutRows) {
  for (const Memory memory : {Memory::kForgetting, Memory::kWindow}) {
    const auto store = store_with({.memory = memory, .memory_blocks = 5.0});
    feed(*store, random_rows(40, 10, 5), kMany);
    const auto before = std::make_unique<ScaleFactors>();
    store->total_to(*before);
    for (std::int64_t b = 40; b < 1000; ++b) {
      store->close(b);
      for (int k = 0; k < 600; ++k) store->step();
    }
    const auto after = std::make_unique<ScaleFactors>();
    store->total_to(*after);
    for (std::size_t s = 0; s < kScales; ++s) {
      EXPECT_EQ(before->factor[s].packed(), after->factor[s].packed());
      EXPECT_EQ(before->rows[s], after->rows[s]);
    }
  }
}

TEST(BlockStore, CompactionHalvesTheEntriesAndKeepsTheirSum) {
  const auto rows = random_rows(static_cast<std::int64_t>(kEntries) + 1, 12, 6);
  const auto store = store_with({});
  feed(*store, rows, kMany);
  EXPECT_EQ(store->blocks_per_entry(), 2U);
  const auto entries = entries_of(*store);
  ASSERT_EQ(entries.size(), kEntries / 2 + 1);
  for (std::size_t e = 0; e + 1 < entries.size(); ++e) EXPECT_EQ(entries[e].blocks, 2U);
  EXPECT_EQ(entries.back().blocks, 1U);
  for (std::size_t s = 0; s < kScales; ++s) {
    for (std::size_t e = 0; e < entries.size(); ++e) {
      const auto own = batch_gram(rows, s, [e](std::int64_t b) {
        return static_cast<std::size_t>(b) / 2 == e ? 1.0 : 0.0;
      });
      EXPECT_LT(relative_difference(entries[e].factor[s].gram(), own), 1e-12) << e;
    }
  }
}

TEST(BlockStore, EntriesStayEvenOverManyCompactions) {
  const auto store = store_with({});
  feed(*store, random_rows(1000, 1, 7), kMany);
  const auto entries = entries_of(*store);
  std::uint32_t blocks = 0;
  for (const auto& e : entries) blocks += e.blocks;
  EXPECT_EQ(blocks, 1000U);
  EXPECT_GE(entries.size(), kEntries / 2);
  for (std::size_t e = 0; e + 1 < entries.size(); ++e)
    EXPECT_EQ(entries[e].blocks, store->blocks_per_entry());
}

TEST(BlockStore, FinishGivesTheSameBitsAsStepping) {
  const auto rows = random_rows(75, 8, 8);
  const auto stepped = store_with({});
  const auto finished = store_with({});
  feed(*stepped, rows, kMany);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    finished->absorb(rows[i].block, rows[i].scale, rows[i].row);
    if (i + 1 < rows.size() && rows[i + 1].block == rows[i].block) continue;
    finished->close(rows[i].block);
    finished->finish();
  }
  const auto a = std::make_unique<ScaleFactors>();
  const auto b = std::make_unique<ScaleFactors>();
  stepped->total_to(*a);
  finished->total_to(*b);
  for (std::size_t s = 0; s < kScales; ++s) EXPECT_EQ(a->factor[s].packed(), b->factor[s].packed());
}

// Rows are gathered by eights; what is left of them, one to seven, counts as much.
TEST(BlockStore, TheTotalEqualsTheBatchForAnyNumberOfRows) {
  for (int count = 1; count <= 17; ++count) {
    const auto rows = random_rows(5, count, 12);
    const auto store = store_with({});
    feed(*store, rows, kMany);
    EXPECT_LT(worst_difference(*store, rows, [](std::int64_t) { return 1.0; }), 1e-12) << count;
  }
}

/// A closed block is merged by and by: after one step its rows are still open. What is empty takes
/// a block scale by scale.
TEST(BlockStore, SpreadsTheWorkOverManySteps) {
  const auto store = store_with({});
  feed(*store, random_rows(2, 30, 9), 0);
  const int scales = static_cast<int>(kScales);
  const int merges = 3 * scales + scales * kRowColumns;
  const int needed = (merges + BlockStore::kMergesPerStep - 1) / BlockStore::kMergesPerStep;
  for (int k = 0; k < needed - 1; ++k) store->step();
  EXPECT_GT(store->rows(1), 0.0) << "not yet";
  store->step();
  EXPECT_EQ(store->rows(1), 0.0);
  const auto total = std::make_unique<ScaleFactors>();
  store->total_to(*total);
  EXPECT_EQ(total->blocks, 2U);
}

/// Rows and closings as the Estimator gives them, sample by sample: rows of short windows come
/// earlier than those of long ones, a block closes when its longest window is complete.
class BlockStoreInTime : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Rates, BlockStoreInTime, testing::Values(150.0, 200.0, 300.0, 400.0));

TEST_P(BlockStoreInTime, NoRowIsLostOrCountedTwice) {
  constexpr std::int64_t kBlocks = 70;  // two compactions
  constexpr int kRows = 12;             // per scale and block
  constexpr std::array<double, kScales> kReachS{2.70, 2.35, 2.18, 2.09, 2.05};
  const auto ticks = [](double s) { return std::llround(s * GetParam()); };
  const auto rows = random_rows(kBlocks, kRows, 10);
  const auto store = store_with({});
  std::vector<std::vector<std::size_t>> arriving(
      static_cast<std::size_t>(ticks(2.0 * kBlocks + 4)));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto number = static_cast<double>(i / kScales % kRows);
    const double centre_s = 2.0 * (static_cast<double>(rows[i].block) + number / kRows);
    arriving[static_cast<std::size_t>(ticks(centre_s + kReachS[rows[i].scale]))].push_back(i);
  }
  std::int64_t open = 0;
  for (std::size_t t = 0; t < arriving.size(); ++t) {
    for (const std::size_t i : arriving[t])
      store->absorb(rows[i].block, rows[i].scale, rows[i].row);
    if (static_cast<std::int64_t>(t) == ticks(2.0 * static_cast<double>(open + 1) + kReachS[0]))
      store->close(open++);
    store->step();
  }
  for (; open < kBlocks; ++open) store->close(open);
  store->finish();
  EXPECT_LT(worst_difference(*store, rows, [](std::int64_t) { return 1.0; }), 1e-12);
  const auto total = std::make_unique<ScaleFactors>();
  store->total_to(*total);
  EXPECT_EQ(total->blocks, kBlocks);
  double in_entries = 0.0;
  double relative = 0.0;
  std::array<RowFactor, kScales> joined{};
  for (const ScaleFactors& e : entries_of(*store)) {
    for (std::size_t s = 0; s < kScales; ++s) {
      joined[s].merge(e.factor[s]);
      in_entries += e.rows[s];
    }
  }
  for (std::size_t s = 0; s < kScales; ++s)
    relative = std::max(relative, relative_difference(joined[s].gram(), total->factor[s].gram()));
  EXPECT_EQ(in_entries, static_cast<double>(rows.size()));
  EXPECT_LT(relative, 1e-12) << "the entries together are the total";
}

TEST(BlockStore, ClearForgetsWhatWasMergedAndKeepsOpenBlocks) {
  const auto rows = random_rows(40, 9, 11);
  const auto store = store_with({});
  for (const PlainRow& r : rows) {
    if (r.block == 39) continue;
    store->absorb(r.block, r.scale, r.row);
    if (&r == &rows.back() || (&r + 1)->block != r.block) {
      store->close(r.block);
      store->finish();
    }
  }
  for (const PlainRow& r : rows) {
    if (r.block == 39) store->absorb(r.block, r.scale, r.row);
  }
  EXPECT_EQ(store->blocks_per_entry(), 2U);
  store->clear();
  EXPECT_EQ(store->blocks_per_entry(), 1U) << "as in a new run";
  store->close(39);
  store->finish();
  EXPECT_LT(worst_difference(*store, rows, [](std::int64_t b) { return b == 39 ? 1.0 : 0.0; }),
            1e-12);
  EXPECT_EQ(entries_of(*store).size(), 1U);
}

}  // namespace
}  // namespace dampline

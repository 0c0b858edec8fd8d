// SPDX-License-Identifier: MIT
#include "dampline/estimate/merge.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "tests/estimate/random_rows.hpp"

namespace dampline {
namespace {

/// Statistics of blocks first...last - 1, by a store, as the Estimator exports them.
std::unique_ptr<Statistics> statistics_of(const std::vector<PlainRow>& rows, std::int64_t first,
                                          std::int64_t last) {
  const auto store = std::make_unique<BlockStore>(BlockStore::Config{});
  std::vector<PlainRow> own;
  for (const PlainRow& r : rows) {
    if (r.block >= first && r.block < last) own.push_back(r);
  }
  feed(*store, own, 2000);
  auto out = std::make_unique<Statistics>();
  out->header.basis_hash = 77;
  out->header.blocks_per_entry = store->blocks_per_entry();
  store->total_to(out->total);
  std::array<const ScaleFactors*, kEntries> entries{};
  const std::size_t count = store->entries_to(entries);
  for (std::size_t i = 0; i < count; ++i) out->entries[i] = *entries[i];
  out->header.entry_count = static_cast<std::uint32_t>(count);
  const auto blocks = static_cast<std::uint64_t>(last - first);
  out->header.counts = {.samples = 600 * blocks,
                        .gaps = 2,
                        .lost = 3,
                        .saturated = 4,
                        .stuck = 5,
                        .not_finite = 6,
                        .repeated = 7,
                        .blocks = blocks,
                        .blocks_excluded = 8,
                        .blocks_still = 9,
                        .rows = own.size(),
                        .rows_still = 10};
  out->header.velocity.moving = 500 * blocks;
  out->header.velocity.sticking = 10 * blocks;
  out->header.velocity.sum_squares = 1e-4 * static_cast<double>(blocks);
  out->header.velocity.positive.fill(blocks);
  out->header.velocity.negative.fill(2 * blocks);
  out->header.newest_tick = 600 * last;
  return out;
}

void expect_total(const Statistics& s, const std::vector<PlainRow>& rows) {
  for (std::size_t scale = 0; scale < kScales; ++scale) {
    const auto truth = batch_gram(rows, scale, [](std::int64_t) { return 1.0; });
    EXPECT_LT(relative_difference(s.total.factor[scale].gram(), truth), 1e-12);
    RowFactor joined;
    for (std::uint32_t e = 0; e < s.header.entry_count; ++e)
      joined.merge(s.entries[e].factor[scale]);
    EXPECT_LT(relative_difference(joined.gram(), truth), 1e-12) << "entries";
  }
}

class MergeAt : public testing::TestWithParam<std::int64_t> {};
INSTANTIATE_TEST_SUITE_P(Splits, MergeAt, testing::Values(1, 10, 28, 29, 57, 113, 149));

TEST_P(MergeAt, TwoPartsMergeToTheWhole) {
  constexpr std::int64_t kBlocks = 150;
  const auto rows = random_rows(kBlocks, 6, 1);
  const auto merged = statistics_of(rows, 0, GetParam());
  const auto second = statistics_of(rows, GetParam(), kBlocks);
  const auto result = merge(*merged, *second);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.value(), kBlocks);
  expect_total(*merged, rows);
  EXPECT_LE(merged->header.entry_count, kEntries);
  std::uint32_t blocks = 0;
  for (std::uint32_t e = 0; e < merged->header.entry_count; ++e)
    blocks += merged->entries[e].blocks;
  EXPECT_EQ(blocks, kBlocks);
}

TEST(Merge, CountsAdd) {
  const auto rows = random_rows(50, 2, 2);
  const auto merged = statistics_of(rows, 0, 20);
  const auto second = statistics_of(rows, 20, 50);
  ASSERT_TRUE(merge(*merged, *second).ok());
  const auto whole = statistics_of(rows, 0, 50);
  const auto& a = merged->header;
  const auto& b = whole->header;
  EXPECT_EQ(a.counts.samples, b.counts.samples);
  EXPECT_EQ(a.counts.blocks, b.counts.blocks);
  EXPECT_EQ(a.counts.rows, b.counts.rows);
  EXPECT_EQ(a.counts.gaps, 4U);
  EXPECT_EQ(a.counts.lost, 6U);
  EXPECT_EQ(a.counts.saturated, 8U);
  EXPECT_EQ(a.counts.stuck, 10U);
  EXPECT_EQ(a.counts.not_finite, 12U);
  EXPECT_EQ(a.counts.repeated, 14U);
  EXPECT_EQ(a.counts.blocks_excluded, 16U);
  EXPECT_EQ(a.counts.blocks_still, 18U);
  EXPECT_EQ(a.counts.rows_still, 20U);
  EXPECT_EQ(a.velocity.moving, b.velocity.moving);
  EXPECT_EQ(a.velocity.sticking, b.velocity.sticking);
  EXPECT_NEAR(a.velocity.sum_squares, b.velocity.sum_squares, 1e-15);
  EXPECT_EQ(a.velocity.positive, b.velocity.positive);
  EXPECT_EQ(a.velocity.negative, b.velocity.negative);
  EXPECT_EQ(a.newest_tick, b.newest_tick);
}

TEST(Merge, TheNoiseAndTheTickAreTheLarger) {
  const auto rows = random_rows(20, 2, 2);
  for (const bool first_larger : {true, false}) {
    const auto first = statistics_of(rows, 0, 10);
    const auto second = statistics_of(rows, 10, 20);
    first->header.noise_mps2 = first_larger ? 0.03 : 0.01;
    second->header.noise_mps2 = first_larger ? 0.01 : 0.03;
    first->header.newest_tick = first_larger ? 500 : 100;
    second->header.newest_tick = first_larger ? 100 : 500;
    ASSERT_TRUE(merge(*first, *second).ok());
    EXPECT_EQ(first->header.noise_mps2, 0.03);
    EXPECT_EQ(first->header.newest_tick, 500);
  }
}

// No entry is longer than the others, none but the last of either part shorter; their order stays.
TEST(Merge, EntriesStayInOrderAndOfOneLength) {
  const auto rows = random_rows(260, 1, 6);
  for (const auto& [first, second] : {std::pair{200, 60}, std::pair{30, 230}, std::pair{28, 1}}) {
    const auto merged = statistics_of(rows, 0, first);
    ASSERT_TRUE(merge(*merged, *statistics_of(rows, first, first + second)).ok());
    const std::uint32_t length = merged->header.blocks_per_entry;
    EXPECT_GE(length * kEntries, static_cast<std::uint32_t>(first + second));
    std::int64_t block = 0;
    std::uint32_t shorter = 0;
    for (std::uint32_t e = 0; e < merged->header.entry_count; ++e) {
      const ScaleFactors& entry = merged->entries[e];
      EXPECT_LE(entry.blocks, length);
      shorter += entry.blocks < length ? 1 : 0;
      const std::int64_t end = block + entry.blocks;
      const auto truth =
          batch_gram(rows, 2, [&](std::int64_t b) { return b >= block && b < end ? 1.0 : 0.0; });
      EXPECT_LT(relative_difference(entry.factor[2].gram(), truth), 1e-12) << e;
      block = end;
    }
    EXPECT_EQ(block, first + second);
    EXPECT_LE(shorter, 2U);
  }
}

TEST(Merge, ManySmallPartsMergeToTheWhole) {
  const auto rows = random_rows(120, 4, 3);
  const auto merged = statistics_of(rows, 0, 3);
  for (std::int64_t b = 3; b < 120; b += 3) {
    ASSERT_TRUE(merge(*merged, *statistics_of(rows, b, b + 3)).ok());
  }
  expect_total(*merged, rows);
}

TEST(Merge, AnEmptyPartChangesNothing) {
  const auto rows = random_rows(40, 4, 4);
  const auto merged = statistics_of(rows, 0, 40);
  Statistics empty{};
  empty.header.basis_hash = 77;
  ASSERT_TRUE(merge(*merged, empty).ok());
  expect_total(*merged, rows);
  auto into = std::make_unique<Statistics>();
  into->header.basis_hash = 77;
  ASSERT_TRUE(merge(*into, *statistics_of(rows, 0, 40)).ok());
  expect_total(*into, rows);
}

TEST(Merge, RefusesAnotherBasisAndChangesNothing) {
  const auto rows = random_rows(40, 4, 5);
  const auto into = statistics_of(rows, 0, 20);
  const auto from = statistics_of(rows, 20, 40);
  from->header.basis_hash = 78;
  const auto before = std::make_unique<Statistics>(*into);
  const auto result = merge(*into, *from);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error(), Errc::kMismatch);
  for (std::size_t s = 0; s < kScales; ++s)
    EXPECT_EQ(into->total.factor[s].packed(), before->total.factor[s].packed());
  EXPECT_EQ(into->header.entry_count, before->header.entry_count);
  EXPECT_EQ(into->header.counts.blocks, before->header.counts.blocks);
  EXPECT_EQ(into->header.velocity.moving, before->header.velocity.moving);
  EXPECT_EQ(into->total.blocks, before->total.blocks);
}

}  // namespace
}  // namespace dampline

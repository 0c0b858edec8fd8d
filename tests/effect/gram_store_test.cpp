// SPDX-License-Identifier: MIT
#include "dampline/effect/gram_store.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace dampline::effect {
namespace {

TEST(GramStore, NothingIsLostWhenEntriesAreJoined) {
  const auto store = std::make_unique<GramStore>();
  double rows = 0.0;
  double squares = 0.0;
  constexpr int kBlocks = 133;
  for (int block = 0; block < kBlocks; ++block) {
    for (int r = 0; r < 3; ++r) {
      Row row = Row::Zero();
      row[0] = block + 1.0;
      row[kTarget] = r - 1.0;
      store->absorb(block, 2, row);
      rows += 1.0;
      squares += row[0] * row[0];
    }
    store->close(block);
    for (int i = 0; i < 600; ++i) store->step();
  }
  store->finish();
  double stored_rows = 0.0;
  double stored_squares = 0.0;
  std::uint32_t blocks = 0;
  for (std::size_t e = 0; e < store->count(); ++e) {
    stored_rows += store->entry(e).rows[2];
    stored_squares += store->entry(e).gram[2].at(0, 0);
    blocks += store->entry(e).blocks;
    EXPECT_LE(store->entry(e).blocks, store->blocks_per_entry());
    EXPECT_EQ(store->entry(e).rows[1], 0.0);
  }
  EXPECT_EQ(blocks, kBlocks);
  EXPECT_DOUBLE_EQ(stored_rows, rows);
  EXPECT_DOUBLE_EQ(stored_squares, squares);
  EXPECT_EQ(store->blocks_per_entry(), 4U);
  EXPECT_EQ(store->count(), 34U);
}

TEST(GramStore, ABlockWithoutRowsIsNoBlock) {
  const auto store = std::make_unique<GramStore>();
  store->close(0);
  store->finish();
  EXPECT_EQ(store->count(), 0U);
}

}  // namespace
}  // namespace dampline::effect

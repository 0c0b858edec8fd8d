// SPDX-License-Identifier: MIT
#include "dampline/estimate/block_ledger.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace dampline {
namespace {

using Fault = BlockLedger::Fault;

TEST(BlockLedger, NamesTheFirstFaultOfABlock) {
  BlockLedger ledger;
  for (int i = 0; i < 100; ++i) ledger.add_row(3);
  ledger.mark(3, Fault::kStuck);
  ledger.mark(3, Fault::kGap);
  EXPECT_EQ(ledger.close(3, 100), BlockStatus::kExcludedStuck);
}

TEST(BlockLedger, EveryFaultExcludesByItsName) {
  for (const auto& [fault, status] : {std::pair{Fault::kGap, BlockStatus::kExcludedGap},
                                      std::pair{Fault::kSaturated, BlockStatus::kExcludedSaturated},
                                      std::pair{Fault::kStuck, BlockStatus::kExcludedStuck},
                                      std::pair{Fault::kNotFinite, BlockStatus::kExcludedNotFinite},
                                      std::pair{Fault::kSpoilt, BlockStatus::kExcludedSpoilt}}) {
    BlockLedger ledger;
    for (std::int64_t block = 0; block < 16; ++block) ledger.add_row(block);
    ledger.mark(7, fault);
    for (std::int64_t block = 0; block < 16; ++block)
      EXPECT_EQ(ledger.close(block, 1), block == 7 ? status : BlockStatus::kUsed)
          << "sixteen blocks are open";
  }
}

TEST(BlockLedger, TellsWholeBlocksFromPartial) {
  BlockLedger ledger;
  for (int i = 0; i < 100; ++i) ledger.add_row(1);
  for (int i = 0; i < 99; ++i) ledger.add_row(2);
  EXPECT_EQ(ledger.close(1, 100), BlockStatus::kUsed);
  EXPECT_EQ(ledger.close(2, 100), BlockStatus::kPartial);
  EXPECT_EQ(ledger.close(4, 100), BlockStatus::kPartial) << "no rows at all";
}

TEST(BlockLedger, IsStillWhenNoRowPassedTheGate) {
  BlockLedger ledger;
  for (int i = 0; i < 100; ++i) ledger.add_still_row(1);
  EXPECT_EQ(ledger.close(1, 100), BlockStatus::kStill);
  for (int i = 0; i < 60; ++i) ledger.add_still_row(2);
  for (int i = 0; i < 40; ++i) ledger.add_row(2);
  EXPECT_EQ(ledger.close(2, 100), BlockStatus::kUsed);
  for (int i = 0; i < 40; ++i) ledger.add_still_row(4);
  for (int i = 0; i < 60; ++i) ledger.add_row(4);
  EXPECT_EQ(ledger.close(4, 100), BlockStatus::kUsed);
  ledger.add_still_row(3);
  EXPECT_EQ(ledger.close(3, 100), BlockStatus::kStill) << "not one row moved";
}

TEST(BlockLedger, ABlockInTheSamePlaceStartsClean) {
  BlockLedger ledger;
  ledger.mark(5, Fault::kSaturated);
  for (int i = 0; i < 10; ++i) ledger.add_row(5 + 16);
  EXPECT_EQ(ledger.close(5 + 16, 10), BlockStatus::kUsed);
}

TEST(BlockReports, ComeOutInTheOrderOfTheirBlocks) {
  BlockReports reports;
  BlockReport out;
  EXPECT_FALSE(reports.pop(out));
  for (std::int64_t i = 0; i < 100; ++i) {
    reports.push({.first_tick = 2 * i, .status = BlockStatus::kUsed});
    reports.push({.first_tick = 2 * i + 1, .status = BlockStatus::kStill});
    ASSERT_TRUE(reports.pop(out));
    EXPECT_EQ(out.first_tick, 2 * i);
    ASSERT_TRUE(reports.pop(out));
    EXPECT_EQ(out.first_tick, 2 * i + 1);
  }
  EXPECT_FALSE(reports.pop(out));
}

TEST(BlockReports, SixteenMayWait) {
  BlockReports reports;
  for (std::int64_t i = 0; i < 16; ++i) reports.push({.first_tick = i});
  BlockReport out;
  for (std::int64_t i = 0; i < 16; ++i) {
    ASSERT_TRUE(reports.pop(out));
    EXPECT_EQ(out.first_tick, i);
  }
}

}  // namespace
}  // namespace dampline

// SPDX-License-Identifier: MIT
// A record of any length in a fixed number of entries.
#include "dampline/numeric/blocks.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <string>
#include <vector>

namespace dampline {
namespace {

TEST(JoinNeighbours, JoinsTwoByTwoInTheirOrder) {
  for (std::size_t count = 0; count <= 9; ++count) {
    std::vector<std::string> entries;
    for (std::size_t i = 0; i < count; ++i) entries.emplace_back(1, static_cast<char>('a' + i));
    const std::size_t left = join_neighbours(
        entries, count, [](std::string& into, const std::string& next) { into += next; });
    EXPECT_EQ(left, (count + 1) / 2);
    entries.resize(left);
    EXPECT_EQ(std::accumulate(entries.begin(), entries.end(), std::string{}),
              std::string{"abcdefghi"}.substr(0, count));
    for (std::size_t i = 0; i + 1 < left; ++i) EXPECT_EQ(entries[i].size(), 2U) << count;
  }
}

TEST(WaitingBlocks, AreTakenInTheOrderInWhichTheyCame) {
  using Waiting = WaitingBlocks<3>;
  EXPECT_EQ(Waiting::slot(7), 1U);
  EXPECT_EQ(Waiting::slot(9), 0U);
  Waiting waiting;
  EXPECT_TRUE(waiting.empty());
  EXPECT_FALSE(waiting.holds(0)) << "of none there is no place";
  waiting.push(2);
  waiting.push(0);
  EXPECT_FALSE(waiting.full());
  EXPECT_TRUE(waiting.holds(2) && waiting.holds(0));
  EXPECT_FALSE(waiting.holds(1));
  waiting.push(1);
  EXPECT_TRUE(waiting.full());
  for (const std::size_t slot : {2U, 0U, 1U}) {
    EXPECT_EQ(waiting.first(), slot);
    waiting.pop();
    EXPECT_FALSE(waiting.holds(slot));
  }
  EXPECT_TRUE(waiting.empty());
}

/// Which blocks each part of an entry has, and how often its counts were told.
struct Diary {
  static constexpr int kParts = 3;
  std::array<std::vector<int>, kParts> parts;
  std::uint32_t blocks{0};
  void clear() { *this = {}; }
  int merge(const Diary& from, int part) {
    const auto& more = from.parts[static_cast<std::size_t>(part)];
    auto& own = parts[static_cast<std::size_t>(part)];
    own.insert(own.end(), more.begin(), more.end());
    return 1;
  }
  void merge_counts(const Diary& from) { blocks += from.blocks; }
  void copy(const Diary& from, int part) {
    parts[static_cast<std::size_t>(part)] = from.parts[static_cast<std::size_t>(part)];
  }
  void copy_counts(const Diary& from) { blocks = from.blocks; }
};
using Entries = BlockEntries<Diary, 4>;

void take(Entries& entries, int block) {
  Diary diary;
  diary.parts.fill({block});
  diary.blocks = 1;
  entries.begin();
  int parts = 0;
  while (!entries.step(diary)) ASSERT_LT(++parts, 100);
}

/// Entries hold the blocks first ... end - 1, each in all of its parts, in their order.
void expect_blocks(const Entries& entries, int first, int end) {
  int block = first;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    EXPECT_LE(entries[i].blocks, entries.blocks_per_entry());
    EXPECT_EQ(entries[i].parts[0].size(), entries[i].blocks);
    EXPECT_EQ(entries[i].parts[1], entries[i].parts[0]);
    EXPECT_EQ(entries[i].parts[2], entries[i].parts[0]);
    for (const int held : entries[i].parts[0]) EXPECT_EQ(held, block++);
  }
  EXPECT_EQ(block, end);
}

TEST(BlockEntries, DoubleTheirLengthWhenAllAreFull) {
  Entries entries;
  EXPECT_EQ(entries.size(), 0U);
  for (int block = 0; block < 100; ++block) {
    take(entries, block);
    expect_blocks(entries, 0, block + 1);
    std::uint32_t length = 1;
    while (4 * length < static_cast<std::uint32_t>(block + 1)) length *= 2;
    EXPECT_EQ(entries.blocks_per_entry(), length) << block;
  }
  entries.clear();
  EXPECT_EQ(entries.blocks_per_entry(), 1U);
  take(entries, 7);
  expect_blocks(entries, 7, 8);
}

// Entries of two blocks at most, and three of them: the oldest leaves.
TEST(BlockEntries, LetTheOldestGoWhereTheyAreAsLongAsTheyMayBe) {
  Entries entries{2, 3};
  for (int block = 0; block < 50; ++block) {
    take(entries, block);
    if (block < 4) {
      expect_blocks(entries, 0, block + 1);
      continue;
    }
    EXPECT_EQ(entries.blocks_per_entry(), 2U);
    EXPECT_EQ(entries.size(), 3U) << block;
    expect_blocks(entries, block < 6 ? 0 : block / 2 * 2 - 4, block + 1);
  }
  entries.keep_oldest(2);
  expect_blocks(entries, 44, 48);
  entries.keep_oldest(5);
  EXPECT_EQ(entries.size(), 2U);
}

TEST(BlockEntries, TellWhichPartTheNextStepAdds) {
  Entries entries;
  Diary diary;
  diary.blocks = 1;
  for (int block = 0; block < 5; ++block) {
    entries.begin();
    int added = 0;
    for (bool done = false; !done;) {
      const bool adds = entries.adds(added);
      EXPECT_FALSE(entries.adds(added + 1));
      EXPECT_TRUE(adds || block == 4) << "only the fifth joins before";
      added += adds ? 1 : 0;
      done = entries.step(diary);
    }
    EXPECT_EQ(added, Diary::kParts);
  }
}

TEST(BlockEntries, TakeTheShapeOfOthers) {
  Entries shape{2, 3};
  for (int block = 0; block < 9; ++block) take(shape, block);
  Entries entries{2, 3};
  entries.resize_as(shape);
  EXPECT_EQ(entries.size(), shape.size());
  EXPECT_EQ(entries.blocks_per_entry(), 2U);
}

}  // namespace
}  // namespace dampline

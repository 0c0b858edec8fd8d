// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "dampline/density/input_statistics.hpp"

namespace dampline {
namespace {

/// Blocks of ten samples with this motion and input.
void give(BlockPowers& powers, int blocks, double velocity_mps, double input_mps2 = 1.0) {
  for (int block = 0; block < blocks; ++block) {
    for (int i = 0; i < 10; ++i) powers.take(velocity_mps, input_mps2);
    powers.close_block();
  }
}

TEST(BlockPowers, KnowAChangeFromEightStretchesOn) {
  BlockPowers powers{0.0};
  give(powers, 7, 0.01);
  EXPECT_FALSE(powers.change().known);
  powers.close_block();
  EXPECT_FALSE(powers.change().known) << "a block without samples is none";
  give(powers, 1, 0.01);
  EXPECT_TRUE(powers.change().known);
  EXPECT_NEAR(powers.change().size, 0.0, 1e-12);
  EXPECT_NEAR(powers.change().chance, 0.0, 1e-7);
  BlockPowers nothing{0.0};
  give(nothing, 20, 0.0, 0.0);
  EXPECT_FALSE(nothing.change().known) << "no power, no ratio";
}

// Three quarters of power 1 and one of 4: a mean of 7 / 4, and 4 over it is the largest ratio.
TEST(BlockPowers, AChangeIsThatOfTheQuarterThatDiffersMost) {
  for (const bool of_motion : {true, false}) {
    for (int quarter = 0; quarter < 4; ++quarter) {
      BlockPowers powers{0.0};
      for (int q = 0; q < 4; ++q) {
        const double size = q == quarter ? 2.0 : 1.0;
        give(powers, 4, of_motion ? size : 1.0, of_motion ? 1.0 : size);
      }
      const BlockPowers::Change change = powers.change();
      ASSERT_TRUE(change.known);
      EXPECT_NEAR(change.size, std::log(4.0 / 1.75), 1e-12);
      // Blocks deviate by 3 sqrt(3 / 16); four of sixteen make a quarter.
      EXPECT_NEAR(change.chance, 3.0 * std::sqrt(3.0 / 16.0 / 4.0) / 1.75, 1e-12);
    }
  }
  BlockPowers less{0.0};
  give(less, 12, 1.0);
  give(less, 4, 0.0);
  EXPECT_GT(less.change().size, 100.0) << "a quarter without any";
}

// 31 stretches at most; neighbours become one, and nothing is lost.
TEST(BlockPowers, OfALongRecordAreItsQuarters) {
  BlockPowers powers{0.0};
  constexpr int kQuarter = 250;
  for (const double velocity : {1.0, 1.0, 2.0, 1.0}) give(powers, kQuarter, velocity);
  EXPECT_NEAR(powers.change().size, std::log(4.0 / 1.75), 0.1);
  EXPECT_TRUE(powers.change().known);
}

// The last three memories: what came before is gone.
TEST(BlockPowers, ForgetWithTheEstimate) {
  BlockPowers powers{32.0};  // three blocks a stretch
  give(powers, 300, 2.0);
  give(powers, 95, 1.0);
  EXPECT_GT(powers.change().size, 0.01) << "one stretch is left";
  give(powers, 1, 1.0);
  EXPECT_NEAR(powers.change().size, 0.0, 1e-12);
}

TEST(BlockPowers, TwoRecordsAppendToOne) {
  for (const auto& [blocks, more] :
       {std::pair{12, 12}, std::pair{16, 8}, std::pair{64, 32}, std::pair{300, 300},
        std::pair{1000, 500}, std::pair{1000, 1000}}) {
    BlockPowers first{0.0};
    BlockPowers second{0.0};
    give(first, blocks, 1.0);
    give(second, more, 2.0);
    first.append(second);
    const BlockPowers::Change change = first.change();
    ASSERT_TRUE(change.known);
    EXPECT_NEAR(change.size, std::log((blocks + 4.0 * more) / (blocks + more)), 0.06)
        << "the first quarter is of the first: " << blocks << " and " << more;
  }
  BlockPowers ring{16.0};
  BlockPowers other{16.0};
  give(ring, 200, 1.0);
  give(other, 64, 2.0);
  ring.append(other);
  EXPECT_NEAR(ring.change().size, 0.0, 1e-12) << "the other's are the newest";
}

// A stretch holds 64 blocks by then: fifty records of seven are five, a quarter of all.
TEST(BlockPowers, ManyShortRecordsBehindALongOneCount) {
  BlockPowers powers{0.0};
  give(powers, 1000, 1.0);
  for (int i = 0; i < 50; ++i) {
    BlockPowers brief{0.0};
    give(brief, 7, 10.0);
    powers.append(brief);
  }
  EXPECT_GT(powers.change().size, 1.0);
}

}  // namespace
}  // namespace dampline

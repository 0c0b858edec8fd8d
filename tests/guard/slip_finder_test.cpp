// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "dampline/guard/wheelset_watch.hpp"

namespace dampline {
namespace {

/// What chunks show: by how much a shift fits better than none does, for each change of 1.
struct Stretch {
  double fit{-1.0};
  double left{1.0};  ///< squared difference of the best, over the usual one
};

/// Chunks one after the other, all with a change of 1.
class ChunkFeed {
 public:
  int delay{40};  ///< samples: nine chunks lie wholly within it
  double sigma{0.05};
  int shift{1};  ///< that fits during a slip

  void feed(int chunks, const Stretch& shown) {
    for (int i = 0; i < chunks; ++i, tick_ += ShiftSums::kSamples) {
      ShiftSums sums;
      const double least = shown.left * 4.0 * sigma * sigma;
      for (std::size_t s = 0; s < ShiftSums::kShifts; ++s) {
        const auto by = static_cast<int>(s) - ShiftSums::kReach;
        sums.change[s] = by == 0 ? 0.0 : 1.0;
        sums.error[s] = least + (by == 0 ? 0.0 : 1.0);
      }
      const auto none = ShiftSums::kNone;
      const auto slipped = none + static_cast<std::size_t>(shift + ShiftSums::kReach) - 4U;
      sums.error[slipped] = shown.fit > 0.0 ? least : least - shown.fit;
      if (shown.fit > 0.0) sums.error[none] = least + shown.fit;
      if (finder_.update(tick_, sums, delay, sigma, slip_)) {
        ++found;
        first_ = first_ ? first_ : slip_;
      }
    }
  }
  /// Before, within and after.
  bool finds(const Stretch& within, const Stretch& before = {}, const Stretch& after = {}) {
    feed(60, before);
    began_ = tick_;
    feed(delay / ShiftSums::kSamples, within);
    feed(60, after);
    return found > 0;
  }
  void restart() { finder_.restart(); }
  [[nodiscard]] const std::optional<SlipFinder::Slip>& first() const { return first_; }
  [[nodiscard]] std::int64_t began() const { return began_; }
  int found{0};

 private:
  SlipFinder finder_;
  SlipFinder::Slip slip_;
  std::optional<SlipFinder::Slip> first_;
  std::int64_t tick_{1000};
  std::int64_t began_{0};
};

constexpr Stretch kSlipped{.fit = 1.0};

TEST(SlipFinder, TellsOnceWhereAndByHowMuch) {
  for (const int shift : {-3, -2, -1, 1, 2, 3}) {
    ChunkFeed feed;
    feed.shift = shift;
    ASSERT_TRUE(feed.finds(kSlipped)) << shift;
    EXPECT_EQ(feed.found, 1);
    EXPECT_EQ(feed.first()->samples, shift);
    EXPECT_EQ(feed.first()->tick, feed.began());
  }
}

TEST(SlipFinder, DoesNotTellFourSamplesFromMore) {
  for (const int shift : {-4, 4}) {
    ChunkFeed feed;
    feed.shift = shift;
    EXPECT_FALSE(feed.finds(kSlipped));
  }
}

TEST(SlipFinder, FitsByMoreThanHalfWithinAndLessBeside) {
  EXPECT_TRUE(ChunkFeed{}.finds({.fit = 0.56}));
  EXPECT_FALSE(ChunkFeed{}.finds({.fit = 0.54}));
  EXPECT_TRUE(ChunkFeed{}.finds(kSlipped, {.fit = -0.46}, {.fit = -0.46}));
  EXPECT_FALSE(ChunkFeed{}.finds(kSlipped, {.fit = -0.44}));
  EXPECT_FALSE(ChunkFeed{}.finds(kSlipped, {}, {.fit = -0.44}));
}

// Of nine chunks with a change of 1 each and a fit of 1: 9 / (2 sigma sqrt(9)) deviations.
TEST(SlipFinder, StandsOutByFourDeviations) {
  ChunkFeed feed;
  feed.sigma = 1.5 / 4.35;
  EXPECT_TRUE(feed.finds(kSlipped));
  ChunkFeed less;
  less.sigma = 1.5 / 4.25;
  EXPECT_FALSE(less.finds(kSlipped));
}

TEST(SlipFinder, LeavesLittleMoreThanUsual) {
  for (const auto& [left, finds] : {std::pair{4.4, true}, std::pair{4.6, false}}) {
    ChunkFeed feed;
    feed.sigma = 0.12;  // a fifteenth of the change is left
    EXPECT_EQ(feed.finds({.fit = 1.0, .left = left}), finds) << left;
  }
}

// Where the wheelsets are usually alike, the ends of a slip leave many times that: 5 % of the
// change.
TEST(SlipFinder, OrLittleOfTheChange) {
  for (const auto& [sigma, finds] : {std::pair{0.0225, true}, std::pair{0.0235, false}}) {
    ChunkFeed feed;
    feed.sigma = sigma;
    EXPECT_EQ(feed.finds({.fit = 1.0, .left = 25.0}), finds) << sigma;
  }
}

TEST(SlipFinder, NeedsADelayOfTwoChunksAndAtMostTwentyFour) {
  for (const auto& [delay, finds] :
       {std::pair{7, false}, std::pair{8, true}, std::pair{99, true}, std::pair{100, false}}) {
    ChunkFeed feed;
    feed.delay = delay;
    feed.sigma = 0.01;
    EXPECT_EQ(feed.finds(kSlipped), finds) << delay;
  }
}

TEST(SlipFinder, KnowsWhatIsUsualFirst) {
  ChunkFeed feed;
  feed.sigma = 0.0;
  EXPECT_FALSE(feed.finds(kSlipped));
}

// 1 % of the windows: more have impacts in them.
TEST(SlipFinder, KeepsQuietWhereManyWindowsHoldMoreThanUsual) {
  for (const auto& [rough, finds] : {std::pair{34, true}, std::pair{50, false}}) {
    ChunkFeed feed;
    feed.feed(60, {});
    feed.feed(rough, {.fit = -1.0, .left = 5.0});
    EXPECT_EQ(feed.finds(kSlipped), finds) << rough;
  }
  ChunkFeed later;
  later.feed(50, {.fit = -1.0, .left = 5.0});
  later.feed(3000, {});
  EXPECT_TRUE(later.finds(kSlipped)) << "what is long ago counts less";
}

TEST(SlipFinder, StartsAnewAfterARestart) {
  ChunkFeed feed;
  feed.feed(60, {});
  feed.restart();
  feed.feed(10, kSlipped);
  feed.feed(11, {});
  EXPECT_EQ(feed.found, 0) << "nothing is known from before it";
  feed.feed(60, {});
  EXPECT_EQ(feed.found, 0);
}

// A slip is reported once, and two delays are waited for; not beyond a restart.
TEST(SlipFinder, FindsAnotherSlipSoonAfterARestart) {
  ChunkFeed feed;
  feed.delay = 92;
  feed.feed(80, {});
  feed.feed(23, kSlipped);
  while (feed.found == 0) feed.feed(1, {});
  feed.restart();
  feed.delay = 8;
  feed.sigma = 0.01;
  feed.feed(12, {});
  feed.feed(2, kSlipped);
  feed.feed(12, {});
  EXPECT_EQ(feed.found, 2);
}

TEST(SlipFinder, TellsTwoSlips) {
  ChunkFeed feed;
  EXPECT_TRUE(feed.finds(kSlipped));
  EXPECT_TRUE(feed.finds(kSlipped));
  EXPECT_EQ(feed.found, 2);
}

}  // namespace
}  // namespace dampline

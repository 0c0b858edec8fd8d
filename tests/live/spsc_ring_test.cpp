// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cstdint>
#include <thread>

#include "app/live/handover.hpp"

namespace dampline::app {
namespace {

TEST(SpscRing, RefusesWhenFullAndGivesBackInOrder) {
  SpscRing<int> ring{5};
  ASSERT_EQ(ring.capacity(), 8U);
  int value = -1;
  EXPECT_FALSE(ring.pop(value));
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 8; ++i) EXPECT_TRUE(ring.push(i));
    EXPECT_FALSE(ring.push(99));
    for (int i = 0; i < 8; ++i) {
      ASSERT_TRUE(ring.pop(value));
      EXPECT_EQ(value, i);
    }
    EXPECT_FALSE(ring.pop(value));
  }
}

TEST(SpscRing, LosesNothingBetweenTwoThreads) {
  constexpr std::uint64_t kMost = 200'000;
  SpscRing<std::uint64_t> ring{64};
  std::thread producer{[&ring] {
    for (std::uint64_t i = 0; i < kMost;)
      if (ring.push(i)) ++i;
  }};
  std::uint64_t expected = 0;
  for (std::uint64_t value = 0; expected < kMost;) {
    if (!ring.pop(value)) continue;
    ASSERT_EQ(value, expected);
    ++expected;
  }
  producer.join();
}

struct Pair {
  std::uint64_t a{0};
  std::uint64_t b{0};
};

TEST(Latest, GivesWholeValuesThatNeverGoBack) {
  constexpr std::uint64_t kMost = 100'000;
  Latest<Pair> latest;
  EXPECT_FALSE(latest.take());
  std::thread writer{[&latest] {
    for (std::uint64_t i = 1; i <= kMost; ++i) {
      latest.back() = {i, ~i};
      latest.publish();
    }
  }};
  std::uint64_t newest = 0;
  while (newest < kMost) {
    if (!latest.take()) continue;
    const Pair seen = latest.front();
    ASSERT_EQ(seen.b, ~seen.a);
    ASSERT_GT(seen.a, newest);
    newest = seen.a;
  }
  writer.join();
  EXPECT_FALSE(latest.take());
}

}  // namespace
}  // namespace dampline::app

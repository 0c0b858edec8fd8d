// SPDX-License-Identifier: MIT
#include "app/live/lateness.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace dampline::app {
namespace {

TEST(Lateness, QuantilesAreWithinSixPercentOfTheSortedOnes) {
  std::mt19937_64 random{7};
  std::lognormal_distribution<double> spread{10.0, 2.0};  // ns
  std::vector<std::int64_t> all;
  Lateness lateness;
  for (int i = 0; i < 100'000; ++i) {
    all.push_back(static_cast<std::int64_t>(spread(random)));
    lateness.add(all.back());
  }
  std::sort(all.begin(), all.end());
  for (const double share : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const auto exact = static_cast<double>(all[static_cast<std::size_t>(share * 1e5)]);
    EXPECT_NEAR(static_cast<double>(lateness.quantile_ns(share)), exact, 0.0626 * exact) << share;
  }
  EXPECT_EQ(lateness.max_ns(), static_cast<std::uint64_t>(all.back()));
  EXPECT_EQ(lateness.count(), 100'000U);
}

TEST(Lateness, BearsTheExtremes) {
  Lateness lateness;
  EXPECT_EQ(lateness.quantile_ns(0.5), 0U);
  lateness.add(-5);
  EXPECT_EQ(lateness.max_ns(), 0U);
  lateness.add(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(lateness.max_ns(),
            static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()));
  EXPECT_EQ(lateness.quantile_ns(0.99), lateness.max_ns());
}

TEST(Lateness, SmallOnesAreExact) {
  for (std::int64_t ns = 0; ns < 32; ++ns) {
    Lateness lateness;
    lateness.add(ns);
    EXPECT_EQ(lateness.quantile_ns(0.5), static_cast<std::uint64_t>(ns));
  }
}

TEST(Lateness, BinsHoldWhatTheirEdgesSay) {
  std::mt19937_64 random{8};
  std::lognormal_distribution<double> spread{6.0, 4.0};  // ns
  std::vector<std::int64_t> all{0, 1, 15, 16, 17, 31, 32, 1'000'000'000};
  while (all.size() < 5'000) all.push_back(static_cast<std::int64_t>(spread(random)));
  Lateness lateness;
  for (const std::int64_t ns : all) lateness.add(ns);
  std::uint64_t total = 0;
  std::uint64_t last_ns = 0;
  lateness.for_each([&](std::uint64_t from_ns, std::uint64_t to_ns, std::uint64_t count) {
    const auto inside = std::count_if(all.begin(), all.end(), [&](std::int64_t ns) {
      return static_cast<std::uint64_t>(ns) >= from_ns && static_cast<std::uint64_t>(ns) < to_ns;
    });
    EXPECT_EQ(count, static_cast<std::uint64_t>(inside)) << from_ns << " to " << to_ns;
    EXPECT_GE(from_ns, last_ns);
    last_ns = to_ns;
    total += count;
  });
  EXPECT_EQ(total, all.size());
}

}  // namespace
}  // namespace dampline::app

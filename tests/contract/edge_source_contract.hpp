// SPDX-License-Identifier: MIT
// What every EdgeSource keeps, whatever the library, checked against a line that the caller moves.
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "hal/edge_source.hpp"

namespace dampline {

/// Moves line 0 to active or inactive; the kernel has seen it when this returns.
using MoveLine = std::function<void(bool active)>;

inline std::vector<hal::Edge> read_all(hal::EdgeSource& source, std::size_t at_once = 64) {
  std::vector<hal::Edge> all;
  std::vector<hal::Edge> some(at_once);
  while (true) {
    const Result<std::size_t> count = source.read(some);
    if (!count.ok() || count.value() == 0) return all;
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count.value()));
  }
}

/// Line 0 is inactive, both its edges are watched, and nobody has moved it since it was opened.
inline void check_edge_source_contract(hal::EdgeSource& source, const MoveLine& move) {
  using std::chrono::milliseconds;
  std::array<hal::Edge, 4> out{};
  const Result<std::size_t> none = source.read(out);
  ASSERT_TRUE(none.ok()) << "no edge is success";
  EXPECT_EQ(none.value(), 0U);
  EXPECT_FALSE(source.wait(milliseconds{20}).value()) << "nothing to wait for";

  for (const bool active : {true, false, true, false, true, false}) move(active);
  EXPECT_TRUE(source.wait(milliseconds{1000}).value());
  EXPECT_EQ(source.read({}).value(), 0U) << "no room is no error";
  EXPECT_EQ(source.read(out).value(), out.size()) << "no more than there is room for";
  const std::vector<hal::Edge> rest = read_all(source);
  ASSERT_EQ(rest.size(), 2U);
  EXPECT_FALSE(source.wait(milliseconds{0}).value());

  std::vector<hal::Edge> all(out.begin(), out.end());
  all.insert(all.end(), rest.begin(), rest.end());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].line, 0);
    EXPECT_EQ(all[i].rising, i % 2 == 0);
    EXPECT_FALSE(all[i].impossible);
    EXPECT_GE(all[i].time_ns, all[i > 0 ? i - 1 : 0].time_ns);
  }
  const hal::EdgeHealth health = source.health();
  EXPECT_EQ(health.edges, 6U);
  EXPECT_EQ(health.impossible, 0U);
  EXPECT_EQ(health.lost.value_or(0), 0U);
}

/// After the chip has gone, for good.
inline void check_gone(hal::EdgeSource& source) {
  std::array<hal::Edge, 4> out{};
  EXPECT_TRUE(source.wait(std::chrono::milliseconds{1000}).value()) << "there is news to read";
  while (source.read(out).ok()) {
  }
  for (int i = 0; i < 3; ++i) {
    const Result<std::size_t> count = source.read(out);
    ASSERT_FALSE(count.ok());
    EXPECT_EQ(count.error(), Errc::kLinkDown);
    EXPECT_TRUE(source.wait(std::chrono::milliseconds{1000}).value());
  }
}

}  // namespace dampline

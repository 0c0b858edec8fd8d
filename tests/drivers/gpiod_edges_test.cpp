// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>

#include "drivers/gpiod/edges.hpp"

namespace dampline::drivers {
namespace {

constexpr std::int64_t kOffsetNs = 1'700'000'000'000'000'000;

EdgeConfig two_lines() {
  return {.chip = "gpiochip0",
          .lines = {{.offset = 3}, {.offset = 5, .falling = false}},
          .run_time = {kOffsetNs}};
}

KernelEdge edge(std::int64_t ns, bool rising, std::optional<std::uint32_t> number = {}) {
  return {.line = 0, .rising = rising, .monotonic_ns = ns, .number = number};
}

TEST(EdgeLedger, GivesRunTime) {
  EdgeLedger ledger{two_lines(), false};
  const hal::Edge got = ledger.enter({.line = 1, .rising = true, .monotonic_ns = 42, .number = {}});
  EXPECT_EQ(got.time_ns, kOffsetNs + 42);
  EXPECT_EQ(got.line, 1);
  EXPECT_TRUE(got.rising);
  EXPECT_EQ(ledger.health().edges, 1U);
}

TEST(EdgeLedger, CallsASecondEdgeOfOneDirectionImpossible) {
  EdgeLedger ledger{two_lines(), false};
  EXPECT_FALSE(ledger.enter(edge(1, false)).impossible);  // the first may be either
  EXPECT_FALSE(ledger.enter(edge(2, true)).impossible);
  EXPECT_TRUE(ledger.enter(edge(3, true)).impossible);
  EXPECT_FALSE(ledger.enter(edge(4, false)).impossible);
  EXPECT_TRUE(ledger.enter(edge(5, false)).impossible);
  EXPECT_EQ(ledger.health().impossible, 2U);
  EXPECT_EQ(ledger.health().edges, 5U);
}

TEST(EdgeLedger, ExpectsNoAlternationWhereOneEdgeIsWatched) {
  EdgeLedger ledger{two_lines(), false};
  for (std::int64_t ns = 0; ns < 5; ++ns) {
    EXPECT_FALSE(
        ledger.enter({.line = 1, .rising = true, .monotonic_ns = ns, .number = {}}).impossible);
  }
  EXPECT_EQ(ledger.health().impossible, 0U);
}

TEST(EdgeLedger, KeepsLinesApart) {
  EdgeLedger ledger{two_lines(), true};
  static_cast<void>(ledger.enter(edge(10, true, 1)));
  const hal::Edge other = ledger.enter({.line = 1, .rising = true, .monotonic_ns = 5, .number = 1});
  EXPECT_EQ(other.time_ns, kOffsetNs + 5);  // earlier than the other line's, and right
  EXPECT_FALSE(other.impossible);
  EXPECT_EQ(ledger.health().reordered, 0U);
  EXPECT_EQ(ledger.health().lost, 0U);
}

TEST(EdgeLedger, HoldsATimeThatWouldGoBack) {
  EdgeLedger ledger{two_lines(), false};
  static_cast<void>(ledger.enter(edge(100, true)));
  EXPECT_EQ(ledger.enter(edge(60, false)).time_ns, kOffsetNs + 100);
  EXPECT_EQ(ledger.enter(edge(90, true)).time_ns, kOffsetNs + 100);
  EXPECT_EQ(ledger.enter(edge(130, false)).time_ns, kOffsetNs + 130);
  EXPECT_EQ(ledger.health().reordered, 2U);
}

TEST(EdgeLedger, CannotTellLossesWithoutNumbers) {
  EdgeLedger ledger{two_lines(), false};
  static_cast<void>(ledger.enter(edge(1, true)));
  EXPECT_FALSE(ledger.health().lost.has_value());
}

TEST(EdgeLedger, CountsLossesByNumber) {
  EdgeLedger ledger{two_lines(), true};
  EXPECT_EQ(ledger.enter(edge(1, true, 3)).lost_before, 2U);  // the kernel counts from 1
  EXPECT_EQ(ledger.enter(edge(2, false, 4)).lost_before, 0U);
  EXPECT_EQ(ledger.enter(edge(3, true, 15)).lost_before, 10U);
  EXPECT_EQ(ledger.health().lost, 12U);
}

TEST(EdgeLedger, KnowsWhichEdgeFollowsALoss) {
  EdgeLedger ledger{two_lines(), true};
  static_cast<void>(ledger.enter(edge(1, true, 1)));
  EXPECT_FALSE(ledger.enter(edge(2, true, 3)).impossible);  // the falling one was lost
  EXPECT_TRUE(ledger.enter(edge(3, false, 5)).impossible);  // one lost: this had to be rising
  EXPECT_FALSE(ledger.enter(edge(4, true, 8)).impossible);  // two lost
  EXPECT_EQ(ledger.health().impossible, 1U);
}

TEST(EdgeLedger, FollowsNumbersThroughTheirWrap) {
  EdgeLedger ledger{two_lines(), true};
  static_cast<void>(ledger.enter(edge(1, true, 0x7fffffffU)));
  static_cast<void>(ledger.enter(edge(2, false, 0xfffffffeU)));
  const std::uint64_t before = ledger.health().lost.value();
  EXPECT_EQ(ledger.enter(edge(3, true, 0xffffffffU)).lost_before, 0U);
  EXPECT_EQ(ledger.enter(edge(4, false, 0)).lost_before, 0U);
  EXPECT_EQ(ledger.enter(edge(5, true, 2)).lost_before, 1U);
  EXPECT_EQ(ledger.health().lost.value(), before + 1);
}

TEST(EdgeLedger, CountsNoLossWhereANumberGoesBack) {
  EdgeLedger ledger{two_lines(), true};
  static_cast<void>(ledger.enter(edge(1, true, 1)));
  static_cast<void>(ledger.enter(edge(2, false, 2)));
  EXPECT_EQ(ledger.enter(edge(3, true, 2)).lost_before, 0U);
  EXPECT_EQ(ledger.enter(edge(4, false, 1)).lost_before, 0U);
  EXPECT_EQ(ledger.enter(edge(5, true, 0x80000002U)).lost_before, 0U) << "half round is back";
  EXPECT_EQ(ledger.health().lost, 0U);
}

TEST(GpioText, CompletesTheNameOfAChip) {
  EXPECT_EQ(chip_path("gpiochip2"), "/dev/gpiochip2");
  EXPECT_EQ(chip_path("/dev/marker"), "/dev/marker");
}

TEST(GpioText, RefusesLinesThatCannotBe) {
  EdgeConfig config{.chip = "gpiochip0", .lines = {}, .run_time = {}};
  EXPECT_TRUE(check_lines(config));
  config.lines = {{.offset = 1}, {.offset = 2}};
  EXPECT_FALSE(check_lines(config));
  config.lines.push_back({.offset = 1});
  ASSERT_TRUE(check_lines(config));
  EXPECT_EQ(check_lines(config)->text, "gpiochip0 line 1: named twice, expected once");
  config.lines = {{.offset = 4, .rising = false, .falling = false}};
  ASSERT_TRUE(check_lines(config));
  EXPECT_EQ(check_lines(config)->code, Errc::kInvalidConfig);
  config.lines.clear();
  for (unsigned offset = 0; offset < 65; ++offset) config.lines.push_back({.offset = offset});
  EXPECT_TRUE(check_lines(config));
  config.lines.pop_back();
  EXPECT_FALSE(check_lines(config));
}

TEST(Gpiod, SaysWhichChipIsMissing) {
  const auto edges = open_edges({.chip = "gpiochip_none", .lines = {{}}, .run_time = {}});
  ASSERT_FALSE(edges.ok());
  EXPECT_NE(edges.error_text().find("/dev/gpiochip_none: "), std::string::npos)
      << edges.error_text();
  EXPECT_NE(edges.error_text().find("expected"), std::string::npos);
  const auto output = open_output({.chip = "gpiochip_none"});
  ASSERT_FALSE(output.ok());
  EXPECT_NE(output.error_text().find("/dev/gpiochip_none: "), std::string::npos);
  EXPECT_NE(gpio_library().find("libgpiod"), std::string::npos);
}

}  // namespace
}  // namespace dampline::drivers

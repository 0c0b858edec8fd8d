// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>

#include "dampline/sample/assembler.hpp"
#include "frame_maker.hpp"

namespace dampline {
namespace {

using test::assemble;
using test::Nodes;
using test::run;
using test::sort_by_time;

constexpr std::int64_t kTicks = 3000;
constexpr std::int64_t kClean = 40;  // at either end, where losses could not be known

FrameLedger ledger_after(const Nodes& nodes, const std::vector<CanFrame>& frames,
                         std::uint64_t kernel_drops = 0) {
  SampleAssembler assembler{nodes.config()};
  static_cast<void>(assemble(assembler, frames));
  return ledger_of(assembler.counts(), kernel_drops);
}

std::uint64_t sum(const FrameLedger& ledger) {
  return ledger.processed + ledger.kernel_drops + ledger.gaps + ledger.excluded;
}

TEST(Ledger, FindsNothingWrongInACleanRun) {
  const Nodes nodes;
  const FrameLedger ledger = ledger_after(nodes, run(nodes, 0, kTicks));
  EXPECT_EQ(ledger.sent, 3U * kTicks);
  EXPECT_EQ(ledger.processed, 3U * kTicks);
  EXPECT_EQ(ledger.gaps, 0U);
  EXPECT_EQ(ledger.excluded, 0U);
}

/// Frames lost, doubled and swapped, each with its probability; what happened is written down.
struct Mistreated {
  std::vector<CanFrame> frames;
  std::uint64_t sent{0};
  std::uint64_t lost{0};
  std::uint64_t doubled{0};
  std::uint64_t complete{0};  // instants of which all three frames arrived
};

Mistreated mistreat(const Nodes& nodes, unsigned seed, double share) {
  std::mt19937 random{seed};
  std::bernoulli_distribution happens{share};
  Mistreated all;
  std::array<std::set<std::int64_t>, kChannels> arrived;
  for (std::size_t c = 0; c < kChannels; ++c) {
    std::vector<std::int64_t> ticks;
    for (std::int64_t tick = 0; tick < kTicks; ++tick) {
      const bool clean = tick < kClean || tick >= kTicks - kClean;
      ++all.sent;
      if (!clean && happens(random)) {
        ++all.lost;
        continue;
      }
      ticks.push_back(tick);
      arrived[c].insert(tick);
      if (clean || !happens(random)) continue;
      ticks.push_back(tick);
      ++all.sent;
      ++all.doubled;
    }
    for (std::size_t i = 2 * kClean; i + 2 * kClean < ticks.size(); ++i) {
      if (happens(random)) std::swap(ticks[i], ticks[i + 1]);
    }
    std::int64_t latest_ns = 0;
    for (const std::int64_t tick : ticks) {
      CanFrame frame = nodes.frame(c, tick);
      // A swapped or doubled frame arrives right behind the one before.
      frame.time_ns = latest_ns = std::max(frame.time_ns, latest_ns + 30'000);
      all.frames.push_back(frame);
    }
  }
  for (const std::int64_t tick : arrived[0])
    all.complete += arrived[1].count(tick) * arrived[2].count(tick);
  sort_by_time(all.frames);
  return all;
}

class LedgerOfATenth : public ::testing::TestWithParam<unsigned> {};

TEST_P(LedgerOfATenth, LostDoubledAndSwappedAccountsForEveryFrame) {
  const Nodes nodes;
  const Mistreated run = mistreat(nodes, GetParam(), 0.1);
  const FrameLedger ledger = ledger_after(nodes, run.frames);
  EXPECT_EQ(ledger.sent, run.sent);
  EXPECT_EQ(sum(ledger), run.sent);
  EXPECT_EQ(ledger.processed, 3 * run.complete);
  EXPECT_EQ(ledger.gaps, run.lost);
  EXPECT_EQ(ledger.repeated, run.doubled);
  EXPECT_EQ(ledger.without_partner, run.frames.size() - run.doubled - 3 * run.complete);
  EXPECT_EQ(ledger.excluded, ledger.repeated + ledger.without_partner);
}
INSTANTIATE_TEST_SUITE_P(Seeds, LedgerOfATenth, ::testing::Range(1U, 21U));

TEST(Ledger, TakesKernelDropsOutOfTheGaps) {
  const Nodes nodes;
  auto frames = run(nodes, 0, kTicks);
  frames.erase(frames.begin() + 3000, frames.begin() + 3500);
  const FrameLedger ledger = ledger_after(nodes, frames, 400);
  EXPECT_EQ(ledger.sent, 3U * kTicks);
  EXPECT_EQ(ledger.kernel_drops, 400U);
  EXPECT_EQ(ledger.gaps, 100U);
}

// Whatever the counter stood at: a step back of a few looks like frames that come late.
TEST(Ledger, AccountsForARestartedNode) {
  for (const std::int64_t counter_before : {3, 10, 31, 33, 100, 200, 248}) {
    const Nodes nodes;
    constexpr std::int64_t kOff = 7;  // frames that the node did not send meanwhile
    constexpr std::int64_t kAgain = 1500;
    const std::int64_t before = 256 * 40 + counter_before;  // at its last frame, kAgain - kOff - 1
    std::vector<CanFrame> frames;
    for (std::int64_t tick = 0; tick < kTicks; ++tick) {
      for (std::size_t c = 0; c < kChannels; ++c) {
        const bool off = c == 1 && tick >= kAgain - kOff && tick < kAgain;
        const std::int64_t shift =
            c != 1 ? 0 : (tick < kAgain ? before - (kAgain - kOff - 1) : -kAgain);
        if (!off) frames.push_back(nodes.frame(c, tick, 0, shift));
      }
    }
    const FrameLedger ledger = ledger_after(nodes, frames);
    EXPECT_EQ(ledger.sent, 3U * kTicks) << counter_before;
    EXPECT_EQ(ledger.gaps, 7U) << counter_before;
    // At 248 the new counter continues the old one by chance.
    EXPECT_EQ(ledger.repeated + ledger.out_of_step + ledger.too_late,
              counter_before == 248 ? 0U : 3U)
        << counter_before;
  }
}

TEST(Ledger, NamesWhatItExcludes) {
  const Nodes nodes;
  auto frames = run(nodes, 0, kTicks);
  frames[1000].length = 2;
  for (std::size_t i = 2000; i < 2010; ++i) frames[i].error = true;
  CanFrame extra = frames[2500];
  extra.remote = true;
  frames.insert(frames.begin() + 2501, extra);
  extra.remote = false;
  extra.id = 0x7FF;
  frames.insert(frames.begin() + 2501, extra);
  extra = frames[3004];
  extra.data[2] = static_cast<std::uint8_t>(extra.data[2] + 99);  // a counter out of step
  frames[3004] = extra;
  const FrameLedger ledger = ledger_after(nodes, frames);
  EXPECT_EQ(ledger.wrong_length, 1U);
  EXPECT_EQ(ledger.error, 10U);
  EXPECT_EQ(ledger.not_data, 1U);
  EXPECT_EQ(ledger.foreign, 1U);
  EXPECT_EQ(ledger.out_of_step, 1U);
  EXPECT_EQ(ledger.gaps, 10U);  // the ten that became error frames
  EXPECT_EQ(ledger.sent, frames.size() + 10);
  EXPECT_EQ(sum(ledger), ledger.sent);
}

TEST(Ledger, CountsALongPauseByItsTime) {
  const Nodes nodes;
  auto frames = run(nodes, 0, kTicks);
  const auto later = run(nodes, kTicks + 5000, 2 * kTicks + 5000);
  frames.insert(frames.end(), later.begin(), later.end());
  const FrameLedger ledger = ledger_after(nodes, frames);
  EXPECT_EQ(ledger.gaps, 15000U);
  EXPECT_EQ(ledger.sent, 6U * kTicks + 15000U);
  EXPECT_EQ(ledger.excluded, 0U);
}

TEST(Ledger, HoldsWithoutCounters) {
  const Nodes nodes{.counter_bits = 0};
  auto frames = run(nodes, 0, kTicks);
  frames.erase(frames.begin() + 4000);
  frames.erase(frames.begin() + 2000, frames.begin() + 2006);
  const FrameLedger ledger = ledger_after(nodes, frames);
  EXPECT_EQ(ledger.sent, 3U * kTicks);
  EXPECT_EQ(ledger.gaps, 7U);
  EXPECT_EQ(ledger.without_partner, 5U);  // of three instants
}

}  // namespace
}  // namespace dampline

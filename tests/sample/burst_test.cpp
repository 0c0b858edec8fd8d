// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "dampline/sample/assembler.hpp"
#include "frame_maker.hpp"

namespace dampline {
namespace {

using test::assemble;
using test::Nodes;
using test::sort_by_time;

/// A gateway hands frames on so many at once, or as quickly as its bus takes them.
struct Gateway {
  std::int64_t burst{10};
  std::array<std::int64_t, kChannels> phase{};  ///< of each channel's bursts
  std::int64_t pace_ns{0};                      ///< between a channel's frames of one burst
  double loss{0.0};
  std::size_t node{1};      ///< is off for three seconds,
  std::int64_t off_at{0};   ///< from this tick; 0: never
  std::int64_t away_at{0};  ///< the bus is for as long, from this tick of each kAgain; 0: never
  std::int64_t counter_shift{0};

  static constexpr std::int64_t kOff = 900;
  static constexpr std::int64_t kAgain = 3000;
  static constexpr std::int64_t kTicks = 9000;

  [[nodiscard]] std::vector<CanFrame> frames(const Nodes& nodes, std::mt19937& random) const {
    std::uniform_real_distribution<double> chance{0.0, 1.0};
    std::vector<CanFrame> all;
    for (std::int64_t tick = 0; tick < kTicks; ++tick) {
      for (std::size_t c = 0; c < kChannels; ++c) {
        const bool later = c == node && off_at > 0 && tick >= off_at;
        const bool away = away_at > 0 && tick % kAgain >= away_at && tick % kAgain < away_at + kOff;
        if ((later && tick < off_at + kOff) || away || chance(random) < loss) continue;
        CanFrame frame = nodes.frame(c, tick, 0, later ? counter_shift : 0);
        frame.time_ns = nodes.time_of((tick + phase[c]) / burst * burst + burst - phase[c]) +
                        (tick + phase[c]) % burst * pace_ns;
        all.push_back(frame);
      }
    }
    sort_by_time(all);
    return all;
  }
};

/// Whose channels are not of one instant, whatever its tick.
int mixed_samples(const std::vector<Sample>& samples) {
  constexpr std::int64_t kCodes = 1999;
  std::array<std::int64_t, kCodes> instants{};  // by the code of the first channel
  for (std::int64_t tick = 0; tick < kCodes; ++tick)
    instants[static_cast<std::size_t>(Nodes::code(0, tick) + kCodes / 2)] = tick;
  const auto instant = [&](const Sample& sample, std::size_t channel) {
    const std::int64_t code = std::llround(100.0 * sample.accel_mps2[channel]) + kCodes / 2;
    const std::int64_t first = code - 500 * static_cast<std::int64_t>(channel) + kCodes;
    return instants[static_cast<std::size_t>(first % kCodes)];
  };
  return static_cast<int>(std::count_if(samples.begin(), samples.end(), [&](const Sample& sample) {
    const std::int64_t tick = instant(sample, 0);
    return instant(sample, 1) != tick || instant(sample, 2) != tick;
  }));
}

class Burst : public ::testing::TestWithParam<unsigned> {
 protected:
  std::mt19937 random_{GetParam()};
  Nodes nodes_{.counter_bits = GetParam() % 2 == 0 ? 8U : 16U};
  SampleAssembler assembler_{nodes_.config()};
  std::int64_t draw(std::int64_t below) { return static_cast<std::int64_t>(random_()) % below; }
  /// One stamp for all, one system call, a bus of 500 kbit/s, one of 250.
  std::int64_t pace_ns() { return std::array{0, 10'000, 700'000, 1'400'000}[random_() % 4]; }
};

TEST_P(Burst, LosesNothingOfANodeThatStays) {
  Gateway gateway{.burst = 2 + draw(47), .pace_ns = pace_ns()};
  if (gateway.burst <= 16)  // an instant waits no longer for its channels
    for (std::int64_t& phase : gateway.phase) phase = draw(gateway.burst);
  const auto samples = assemble(assembler_, gateway.frames(nodes_, random_));
  EXPECT_EQ(mixed_samples(samples), 0);
  EXPECT_GE(samples.size(), 8940U);
  EXPECT_EQ(assembler_.counts().restarts, 0U);
}

TEST_P(Burst, AlignsANodeThatWasOffAndCountsOn) {
  Gateway gateway{.burst = 2 + draw(47),
                  .pace_ns = pace_ns(),
                  .node = GetParam() % kChannels,
                  .off_at = 60 + draw(4000)};
  const auto samples = assemble(assembler_, gateway.frames(nodes_, random_));
  EXPECT_EQ(mixed_samples(samples), 0);
  EXPECT_GE(samples.size(), 8030U);
}

TEST_P(Burst, AlignsANodeThatWasOffAndStartsAnew) {
  Gateway gateway{.burst = 3 + draw(46),
                  .pace_ns = pace_ns(),
                  .node = GetParam() % kChannels,
                  .off_at = 60 + draw(4000)};
  gateway.counter_shift = draw(60'000);
  if (gateway.burst <= 16)
    for (std::int64_t& phase : gateway.phase) phase = draw(gateway.burst);
  const auto frames = gateway.frames(nodes_, random_);
  const auto samples = assemble(assembler_, frames);
  EXPECT_EQ(mixed_samples(samples), 0);
  EXPECT_GE(samples.size(), 8030U);
  EXPECT_EQ(assembler_.counts().restarts, 1U);
  EXPECT_EQ(assembler_.counts().channels[gateway.node].realigned, 1U);
  const FrameLedger ledger = ledger_of(assembler_.counts(), 0);
  EXPECT_EQ(ledger.processed + ledger.excluded, frames.size());
}

// With losses in the first bursts behind the pause, too, of which nobody knows yet that they are.
TEST_P(Burst, KnowsHowLongTheBusWasAway) {
  const Gateway gateway{.burst = 3 + draw(46),
                        .pace_ns = pace_ns(),
                        .loss = GetParam() % 2 == 0 ? 0.05 : 0.0,
                        .away_at = 600 + draw(1000)};
  const auto samples = assemble(assembler_, gateway.frames(nodes_, random_));
  EXPECT_EQ(mixed_samples(samples), 0);
  EXPECT_EQ(assembler_.counts().restarts, 3U) << gateway.burst;
  EXPECT_NEAR(static_cast<double>(ledger_of(assembler_.counts(), 0).sent),
              static_cast<double>(kChannels * Gateway::kTicks), 12.0)
      << gateway.burst;
}

TEST_P(Burst, LosesOnlyTheInstantsOfLostFrames) {
  Gateway gateway{.burst = 2 + draw(47), .pace_ns = pace_ns(), .loss = 0.01};
  const auto samples = assemble(assembler_, gateway.frames(nodes_, random_));
  EXPECT_EQ(mixed_samples(samples), 0);
  EXPECT_GE(samples.size(), 8500U) << gateway.burst;
  EXPECT_EQ(assembler_.counts().restarts, 0U) << gateway.burst;
}

INSTANTIATE_TEST_SUITE_P(Seeds, Burst, ::testing::Range(1U, 21U));

}  // namespace
}  // namespace dampline

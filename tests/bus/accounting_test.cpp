// SPDX-License-Identifier: MIT
// Every frame that the sensors make is found again: processed, dropped by the kernel, missing from
// its sequence, or excluded for a reason. In virtual time, on the kernel's own CAN stack; what the
// sensors know of their frames is the truth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <signal.h>
#include <time.h>

#include <optional>
#include <random>
#include <thread>

#include "tests/bus/bus.hpp"
#include "tests/bus/reader.hpp"
#include "tests/bus/sensors.hpp"

namespace dampline::bus {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class TimeTravelAccounting : public testing::Test {
 protected:
  void start(int receive_buffer_bytes = 8 * 1024 * 1024, bool filters = true) {
    reader_.emplace(ReaderConfig{bus_.name(), receive_buffer_bytes, filters});
    sensors_.run(seconds{1});
  }
  /// Ends with a second of undisturbed frames, so that nothing is missing where nobody could know.
  ReaderReport finish() {
    sensors_.fate = {};
    sensors_.run(seconds{1});
    const ReaderReport report = reader_->finish();
    reader_.reset();
    const FrameLedger& ledger = report.ledger;
    EXPECT_EQ(ledger.sent, ledger.processed + ledger.kernel_drops + ledger.gaps + ledger.excluded);
    EXPECT_EQ(report.time_went_back, 0U);
    EXPECT_EQ(report.counts.frames, report.health.frames);
    return report;
  }
  [[nodiscard]] static std::uint64_t times(const ReaderReport& report, hal::EventKind kind) {
    return report.events.at(static_cast<std::size_t>(kind));
  }

  VirtualCan bus_;
  RawSender wire_{bus_.name()};
  Sensors sensors_{wire_};
  std::optional<Reader> reader_;
};

TEST_F(TimeTravelAccounting, FindsNothingMissingInAnUndisturbedRun) {
  start();
  sensors_.run(seconds{8});
  const ReaderReport report = finish();
  EXPECT_EQ(report.ledger.sent, sensors_.made());
  EXPECT_EQ(report.ledger.processed, sensors_.made());
}

TEST_F(TimeTravelAccounting, OfABurstIntoASmallBufferCountsWhatTheKernelDropped) {
  start(4096);
  sensors_.burst(5000 / 3 + 1);
  sensors_.run(seconds{1});
  const ReaderReport report = finish();
  EXPECT_EQ(report.ledger.sent, sensors_.made());
  EXPECT_EQ(report.ledger.gaps, 0U);
  EXPECT_GT(report.ledger.kernel_drops, 4000U);
  EXPECT_EQ(report.ledger.kernel_drops, bus_.carried() - report.health.frames);
}

TEST_F(TimeTravelAccounting, OfAnInterfaceDownForThreeSeconds) {
  start();
  std::thread operating{[this] {
    bus_.down();
    std::this_thread::sleep_for(seconds{3});
    bus_.up();
  }};
  sensors_.run(seconds{4});
  operating.join();
  const ReaderReport report = finish();
  EXPECT_EQ(report.ledger.sent, sensors_.made());
  EXPECT_GE(sensors_.refused(), 2700U);
  EXPECT_EQ(report.ledger.gaps, sensors_.refused());
  EXPECT_EQ(report.ledger.excluded, 0U);
  EXPECT_EQ(times(report, hal::EventKind::kLinkDown), 1U);
  EXPECT_EQ(times(report, hal::EventKind::kLinkUp), 1U);
  EXPECT_EQ(report.health.reopened, 0U);
}

TEST_F(TimeTravelAccounting, OfAnInterfaceDeletedAndMadeAgain) {
  start();
  std::thread operating{[this] {
    bus_.remove();
    std::this_thread::sleep_for(seconds{2});
    bus_.create();
  }};
  sensors_.run(milliseconds{2500});
  operating.join();
  wire_.bind_again();
  sensors_.run(seconds{2});
  const ReaderReport report = finish();
  EXPECT_EQ(report.ledger.sent, sensors_.made());
  EXPECT_EQ(report.ledger.gaps, sensors_.made() - report.health.frames);
  // Nobody listens between the return of the interface and the new socket.
  EXPECT_GE(report.ledger.gaps, sensors_.refused());
  EXPECT_LE(report.ledger.gaps, sensors_.refused() + 300);
  EXPECT_GE(sensors_.refused(), 1800U);
  EXPECT_EQ(report.health.reopened, 1U);
}

TEST_F(TimeTravelAccounting, OfATenthLostDoubledAndSwapped) {
  start();
  std::mt19937 random{7};
  std::bernoulli_distribution happens{0.1};
  std::uint64_t lost = 0;
  std::uint64_t doubled = 0;
  std::uint64_t swapped = 0;
  std::array<std::optional<CanFrame>, kChannels> held;
  const auto mistreat = [&](std::size_t channel, const CanFrame& frame) -> std::vector<CanFrame> {
    if (held[channel]) return {frame, *std::exchange(held[channel], std::nullopt)};
    if (happens(random)) return ++lost, std::vector<CanFrame>{};
    if (happens(random)) return ++doubled, std::vector{frame, frame};
    if (!happens(random)) return {frame};
    ++swapped;
    held[channel] = frame;
    return {};
  };
  sensors_.fate = mistreat;
  sensors_.run(seconds{10});
  sensors_.fate = [&](std::size_t channel, const CanFrame& frame) {  // none is kept for ever
    return held[channel] ? mistreat(channel, frame) : std::vector{frame};
  };
  sensors_.run(seconds{1});
  const ReaderReport report = finish();
  EXPECT_EQ(report.ledger.sent, sensors_.made() + doubled);
  EXPECT_EQ(report.ledger.gaps, lost);
  EXPECT_EQ(report.ledger.repeated, doubled);
  std::uint64_t late = 0;
  for (const ChannelCounts& channel : report.counts.channels) late += channel.late;
  EXPECT_EQ(late, swapped);
  EXPECT_EQ(report.ledger.kernel_drops, 0U);
  EXPECT_EQ(report.ledger.excluded, report.ledger.repeated + report.ledger.without_partner);
}

// 5,000 other frames a second: 17 beside each instant's three. Among them the sensors' own numbers
// as remote requests and as 29-bit identifiers.
std::vector<CanFrame> with_foreign_frames(std::size_t channel, const CanFrame& frame,
                                          std::uint64_t& foreign) {
  std::vector<CanFrame> frames{frame};
  for (std::uint32_t i = 0; i < (channel == 0 ? 5U : 6U); ++i)
    frames.push_back({.id = 0x100 + i, .length = 8});
  frames[1].id = frame.id;
  frames[1].extended = true;
  frames[2].id = frame.id;
  frames[2].remote = true;
  foreign += frames.size() - 1;
  return frames;
}

TEST_F(TimeTravelAccounting, OfFiveThousandForeignFramesASecondSeesNone) {
  start();
  std::uint64_t foreign = 0;
  sensors_.fate = [&](std::size_t channel, const CanFrame& frame) {
    return with_foreign_frames(channel, frame, foreign);
  };
  sensors_.run(seconds{5});
  const ReaderReport report = finish();
  EXPECT_EQ(foreign, 25'500U);
  EXPECT_EQ(bus_.carried(), sensors_.made() + foreign);
  EXPECT_EQ(report.health.frames, sensors_.made());
  EXPECT_EQ(report.ledger.sent, sensors_.made());
  EXPECT_EQ(report.ledger.processed, sensors_.made());
}

TEST_F(TimeTravelAccounting, OfFiveThousandForeignFramesASecondWithoutFiltersExcludesThem) {
  start(8 * 1024 * 1024, false);
  std::uint64_t foreign = 0;
  sensors_.fate = [&](std::size_t channel, const CanFrame& frame) {
    return with_foreign_frames(channel, frame, foreign);
  };
  sensors_.run(seconds{5});
  const ReaderReport report = finish();
  EXPECT_EQ(report.ledger.sent, sensors_.made() + foreign);
  EXPECT_EQ(report.ledger.processed, sensors_.made());
  EXPECT_EQ(report.ledger.foreign + report.ledger.not_data, foreign);
  EXPECT_EQ(report.ledger.not_data, 4500U);  // remote requests with a sensor's own identifier
}

TEST_F(TimeTravelAccounting, OfErrorFramesOfEachClass) {
  start();
  std::uint64_t errors = 0;
  sensors_.fate = [&](std::size_t channel, const CanFrame& frame) -> std::vector<CanFrame> {
    if (channel != 1 || sensors_.instants() % 10 != 0) return {frame};
    const CanFrame error{.id = 1U << (errors++ % 9), .length = CAN_ERR_DLC, .error = true};
    return {error, frame};
  };
  sensors_.run(seconds{3});
  const ReaderReport report = finish();
  EXPECT_EQ(errors, 90U);
  EXPECT_EQ(report.ledger.error, errors);
  EXPECT_EQ(report.health.error_frames, errors);
  EXPECT_EQ(report.ledger.sent, sensors_.made() + errors);
  EXPECT_EQ(report.ledger.processed, sensors_.made());
  EXPECT_EQ(report.health.bus_offs, 10U);
  EXPECT_EQ(report.health.restarts, 10U);
  EXPECT_EQ(times(report, hal::EventKind::kBusError), 70U);
}

void shift_wall_clock(int by_seconds) {
  timespec now{};
  ASSERT_EQ(::clock_gettime(CLOCK_REALTIME, &now), 0);
  now.tv_sec += by_seconds;
  ASSERT_EQ(::clock_settime(CLOCK_REALTIME, &now), 0);
}

TEST_F(TimeTravelAccounting, OfAWallClockSteppedByAnHourAndBack) {
  start();
  shift_wall_clock(3600);
  sensors_.run(seconds{2});
  shift_wall_clock(-3600);
  sensors_.run(seconds{2});
  const ReaderReport report = finish();
  EXPECT_EQ(report.ledger.sent, sensors_.made());
  EXPECT_EQ(report.ledger.processed, sensors_.made());
  EXPECT_EQ(report.health.clock_steps, 2U);
  EXPECT_EQ(times(report, hal::EventKind::kClockStep), 2U);
  EXPECT_EQ(report.health.reordered, 0U);
  EXPECT_LT(report.longest_gap_ns, 10'000'000);
}

TEST_F(TimeTravelAccounting, OfAReaderStoppedForTwoSeconds) {
  start();
  ASSERT_EQ(::kill(reader_->pid(), SIGSTOP), 0);
  sensors_.run(seconds{2});
  ASSERT_EQ(::kill(reader_->pid(), SIGCONT), 0);
  const ReaderReport report = finish();
  EXPECT_EQ(report.ledger.sent, sensors_.made());
  EXPECT_EQ(report.ledger.processed, sensors_.made());
}

TEST_F(TimeTravelAccounting, OfAReaderStoppedForTwoSecondsWithASmallBuffer) {
  start(100 * 1024);
  ASSERT_EQ(::kill(reader_->pid(), SIGSTOP), 0);
  sensors_.run(seconds{2});
  ASSERT_EQ(::kill(reader_->pid(), SIGCONT), 0);
  const ReaderReport report = finish();
  EXPECT_EQ(report.ledger.sent, sensors_.made());
  EXPECT_GT(report.ledger.kernel_drops, 100U);
  EXPECT_EQ(report.ledger.kernel_drops, bus_.carried() - report.health.frames);
  EXPECT_EQ(report.ledger.gaps, 0U);
}

TEST_F(TimeTravelAccounting, OfANodeRestartingWithItsCounterAtZero) {
  start();
  sensors_.restart_node(1, 150);
  sensors_.run(seconds{2});
  const ReaderReport report = finish();
  // What the node did not make while it was off is missing from its sequence all the same.
  EXPECT_EQ(report.ledger.sent, sensors_.made() + 150);
  EXPECT_EQ(report.ledger.gaps, 150U);
  EXPECT_EQ(report.counts.channels[1].realigned, 1U);
  EXPECT_EQ(report.ledger.out_of_step, 3U);  // until the restart is certain
  EXPECT_EQ(report.ledger.excluded, 3U + report.ledger.without_partner);
}

}  // namespace
}  // namespace dampline::bus

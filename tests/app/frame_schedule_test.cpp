// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <csignal>

#include "app/verbs/simulate_send.hpp"
#include "tests/drivers/manual_clock.hpp"

namespace dampline::app {
namespace {

constexpr std::int64_t kFirstNs = 1'700'000'000'000'200'000;
constexpr std::int64_t kSecond = 1'000'000'000;

TEST(FrameSchedule, KeepsTheDistanceFromTheFirstFrame) {
  const ManualClock clock;
  const StopRequest stop;
  FrameSchedule schedule{clock, 1.0};
  const std::int64_t begin_ns = clock.monotonic_ns();
  schedule.start(kFirstNs);
  for (std::int64_t i = 0; i < 10; ++i) {
    schedule.start(kFirstNs + i);  // only the first counts
    EXPECT_TRUE(schedule.wait_for(kFirstNs + i * 3'333'333, stop));
    EXPECT_EQ(clock.monotonic_ns(), begin_ns + i * 3'333'333);
  }
  EXPECT_TRUE(schedule.wait_for(kFirstNs + 3600 * kSecond, stop));
  EXPECT_EQ(clock.monotonic_ns(), begin_ns + 3600 * kSecond);
}

TEST(FrameSchedule, DoesNotAddUpLateness) {
  ManualClock clock;
  const StopRequest stop;
  FrameSchedule schedule{clock, 1.0};
  schedule.start(kFirstNs);
  const std::int64_t begin_ns = clock.monotonic_ns();
  clock.advance(5 * kSecond);  // stopped for a while
  EXPECT_TRUE(schedule.wait_for(kFirstNs + 2 * kSecond, stop));
  EXPECT_EQ(clock.monotonic_ns(), begin_ns + 5 * kSecond);
  EXPECT_TRUE(schedule.wait_for(kFirstNs + 6 * kSecond, stop));
  EXPECT_EQ(clock.monotonic_ns(), begin_ns + 6 * kSecond);
}

TEST(FrameSchedule, DividesBySpeedAndDoesNotWaitAtAllForSpeedZero) {
  const ManualClock clock;
  const StopRequest stop;
  const std::int64_t begin_ns = clock.monotonic_ns();
  FrameSchedule fast{clock, 4.0};
  fast.start(kFirstNs);
  EXPECT_EQ(fast.due_ns(kFirstNs + 86'400 * kSecond), begin_ns + 21'600 * kSecond);
  FrameSchedule at_once{clock, 0.0};
  at_once.start(kFirstNs);
  EXPECT_TRUE(at_once.wait_for(kFirstNs + kSecond, stop));
  EXPECT_EQ(clock.monotonic_ns(), begin_ns);
}

TEST(FrameSchedule, EndsAtASignalWhichEndsNothingElse) {
  const ManualClock clock;
  {
    const StopRequest stop;
    FrameSchedule schedule{clock, 1.0};
    schedule.start(kFirstNs);
    EXPECT_TRUE(schedule.wait_for(kFirstNs, stop));
    std::raise(SIGTERM);
    EXPECT_TRUE(stop.made());
    EXPECT_FALSE(schedule.wait_for(kFirstNs + kSecond, stop));
  }
  EXPECT_FALSE(StopRequest{}.made()) << "it was for that one";
}

}  // namespace
}  // namespace dampline::app

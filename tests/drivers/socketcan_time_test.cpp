// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <vector>

#include "drivers/os/system_clock.hpp"
#include "drivers/socketcan/frame_time.hpp"
#include "tests/drivers/manual_clock.hpp"

namespace dampline::drivers {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kHour = 3'600'000 * kMs;
// Stamps, the offset of run time and steps are each cut to whole microseconds.
constexpr double kDigitsNs = 3000.0;

/// A bus whose frames are stamped by the wall clock and read later.
class FrameTimeTest : public ::testing::Test {
 protected:
  FrameTimeTest() { frame_time_.begin_batch(clock_, true); }
  /// Time passes, then a frame is received. Its true run time is kept beside its stamp.
  void receive_after(std::int64_t time_ns) {
    clock_.advance(time_ns);
    queue_.push_back({clock_.realtime_ns(), run_time_.from_monotonic(clock_.monotonic_ns())});
  }
  /// Reads all; every time must be the true one but for the digits below a microsecond.
  void read_all() {
    step_ns_ = frame_time_.begin_batch(clock_, true);
    for (const Received& received : queue_) {
      CanFrame frame;
      frame_time_.stamp({.software_ns = received.stamp_ns}, frame);
      EXPECT_NEAR(static_cast<double>(frame.time_ns - received.true_ns), 0.0, kDigitsNs);
      EXPECT_EQ(frame.time_source, TimeSource::kSoftware);
      EXPECT_GE(frame.time_ns, newest_ns_);
      newest_ns_ = frame.time_ns;
    }
    queue_.clear();
  }

  struct Received {
    std::int64_t stamp_ns;
    std::int64_t true_ns;
  };
  ManualClock clock_;
  hal::RunTime run_time_{hal::RunTime::start(clock_)};
  FrameTime frame_time_{run_time_, true};
  std::vector<Received> queue_;
  std::int64_t step_ns_{0};
  std::int64_t newest_ns_{0};
};

TEST_F(FrameTimeTest, IsTheStampInWholeMicrosecondsWithoutAStep) {
  clock_.advance(10 * kMs);
  frame_time_.begin_batch(clock_, true);
  CanFrame frame;
  frame_time_.stamp({.software_ns = ManualClock::kStartRealtimeNs + 9 * kMs}, frame);
  EXPECT_EQ(frame.time_ns, 1'700'000'000'009'000'000);
}

TEST_F(FrameTimeTest, DoesNotFollowStepsOfAnHour) {
  for (const std::int64_t step_ns : {kHour, -kHour, kHour, -2 * kHour, 30 * kMs, -5 * kMs}) {
    receive_after(3 * kMs);
    read_all();
    clock_.step_wall(step_ns);
    receive_after(3 * kMs);
    read_all();
    EXPECT_NEAR(static_cast<double>(step_ns_), static_cast<double>(step_ns), kDigitsNs);
    receive_after(3 * kMs);
    read_all();
    EXPECT_EQ(step_ns_, 0);
  }
  EXPECT_EQ(frame_time_.reordered(), 0U);
}

TEST_F(FrameTimeTest, KnowsFramesThatWereStampedBeforeTheStepAndReadAfterIt) {
  for (const std::int64_t step_ns : {kHour, -kHour, 100 * kMs, -100 * kMs}) {
    for (int i = 0; i < 5; ++i) receive_after(kMs);
    clock_.step_wall(step_ns);
    for (int i = 0; i < 5; ++i) receive_after(kMs);
    read_all();
    receive_after(kMs);
    read_all();
  }
  EXPECT_EQ(frame_time_.reordered(), 0U);
}

TEST_F(FrameTimeTest, KnowsThemOverManyBatchesUntilTheQueueHasBeenEmpty) {
  for (int i = 0; i < 300; ++i) receive_after(kMs);
  clock_.step_wall(kHour);
  for (int i = 0; i < 300; ++i) receive_after(kMs);
  for (std::size_t begin = 0; begin < queue_.size(); begin += 64) {
    frame_time_.begin_batch(clock_, false);
    for (std::size_t i = begin; i < std::min(begin + 64, queue_.size()); ++i) {
      CanFrame frame;
      frame_time_.stamp({.software_ns = queue_[i].stamp_ns}, frame);
      EXPECT_NEAR(static_cast<double>(frame.time_ns - queue_[i].true_ns), 0.0, kDigitsNs) << i;
    }
  }
  EXPECT_EQ(frame_time_.reordered(), 0U);
}

TEST_F(FrameTimeTest, KnowsAFrameThatCameJustBeforeTheStepAndJustBehindTheBatch) {
  receive_after(kMs);
  const std::vector<Received> batch = queue_;
  clock_.advance(10'000);
  receive_after(10'000);  // is queued behind the batch
  const Received late = queue_.back();
  clock_.step_wall(kHour);
  clock_.advance(10'000);
  queue_ = batch;
  read_all();
  EXPECT_NE(step_ns_, 0);
  queue_ = {late};
  read_all();
  EXPECT_EQ(frame_time_.reordered(), 0U);
}

TEST_F(FrameTimeTest, HoldsTheOrderWhenTheClockWentToAndFroBetweenTwoBatches) {
  receive_after(kMs);
  read_all();
  clock_.step_wall(kHour);
  for (int i = 0; i < 3; ++i) receive_after(kMs);
  clock_.step_wall(-kHour);
  EXPECT_EQ(frame_time_.begin_batch(clock_, true), 0);
  const std::int64_t now_ns = run_time_.from_monotonic(clock_.monotonic_ns());
  for (const Received& received : queue_) {
    CanFrame frame;
    frame_time_.stamp({.software_ns = received.stamp_ns}, frame);
    EXPECT_GE(frame.time_ns, newest_ns_);
    EXPECT_LE(frame.time_ns, now_ns);
  }
  EXPECT_EQ(frame_time_.reordered(), 3U);
}

TEST_F(FrameTimeTest, TakesAnInterruptionBetweenTwoClocksForNoStep) {
  clock_.interrupt_once(500 * kMs);
  EXPECT_EQ(frame_time_.begin_batch(clock_, true), 0);
  EXPECT_EQ(frame_time_.begin_batch(clock_, true), 0);
}

TEST_F(FrameTimeTest, SumsSmallStepsUntilTheyCount) {
  int steps = 0;
  for (int i = 0; i < 10; ++i) {
    clock_.advance(kMs);
    clock_.step_wall(400'000);
    if (frame_time_.begin_batch(clock_, true) != 0) ++steps;
  }
  EXPECT_EQ(steps, 3);
}

TEST_F(FrameTimeTest, HoldsAnEarlierStampAndCountsIt) {
  clock_.advance(10 * kMs);
  frame_time_.begin_batch(clock_, true);
  CanFrame first;
  CanFrame second;
  frame_time_.stamp({.software_ns = ManualClock::kStartRealtimeNs + 5 * kMs}, first);
  frame_time_.stamp({.software_ns = ManualClock::kStartRealtimeNs + 4 * kMs}, second);
  EXPECT_EQ(second.time_ns, first.time_ns);
  EXPECT_EQ(frame_time_.reordered(), 1U);
}

/// Frames 10 ms apart, stamped by a controller whose clock reads `hardware_ns(elapsed)`. Returns
/// how far the worst of them was off.
template <class HardwareClock>
std::int64_t worst_error_ns(ManualClock& clock, hal::RunTime run_time, FrameTime& frame_time,
                            HardwareClock&& hardware_ns) {
  const std::int64_t begin_ns = run_time.from_monotonic(clock.monotonic_ns());
  std::int64_t worst_ns = 0;
  for (int i = 0; i < 100'000; ++i) {
    clock.advance(10 * kMs);
    frame_time.begin_batch(clock, true);
    const std::int64_t true_ns = run_time.from_monotonic(clock.monotonic_ns());
    CanFrame frame;
    frame_time.stamp(
        {.software_ns = clock.realtime_ns(), .hardware_ns = hardware_ns(true_ns - begin_ns)},
        frame);
    EXPECT_EQ(frame.time_source, TimeSource::kHardware);
    worst_ns = std::max(worst_ns, std::abs(frame.time_ns - true_ns));
  }
  return worst_ns;
}

TEST_F(FrameTimeTest, FollowsAHardwareClockThatDriftsWithoutJumps) {
  for (const std::int64_t per_million : {-100, 100}) {
    const std::int64_t worst_ns =
        worst_error_ns(clock_, run_time_, frame_time_, [&](std::int64_t elapsed_ns) {
          return 123'456'789 + elapsed_ns + elapsed_ns / 1'000'000 * per_million;
        });
    EXPECT_LT(worst_ns, 2 * kMs);
    EXPECT_GT(worst_ns, kMs / 2) << "the drift must have been there";
  }
  EXPECT_EQ(frame_time_.reordered(), 0U);
}

TEST_F(FrameTimeTest, TiesAHardwareClockAnewThatWasReset) {
  const std::int64_t worst_ns =
      worst_error_ns(clock_, run_time_, frame_time_,
                     [](std::int64_t elapsed_ns) { return 1 + elapsed_ns % (400'000 * kMs); });
  EXPECT_LT(worst_ns, 2000);
  EXPECT_EQ(frame_time_.reordered(), 0U);
}

TEST_F(FrameTimeTest, KeepsTheEvennessOfHardwareStampsWhereSoftwareIsLate) {
  std::int64_t last_ns = 0;
  for (int i = 0; i < 1000; ++i) {
    clock_.advance(10 * kMs);
    const std::int64_t late_ns = i % 7 * kMs / 10;
    frame_time_.begin_batch(clock_, true);
    CanFrame frame;
    frame_time_.stamp(
        {.software_ns = clock_.realtime_ns() - kMs + late_ns, .hardware_ns = (i + 1) * 10 * kMs},
        frame);
    if (i > 0) {
      EXPECT_NEAR(static_cast<double>(frame.time_ns - last_ns), 10e6, 2000.0);
    }
    last_ns = frame.time_ns;
  }
}

TEST_F(FrameTimeTest, IgnoresHardwareStampsThatWereNotAskedFor) {
  FrameTime plain{run_time_, false};
  clock_.advance(kMs);
  plain.begin_batch(clock_, true);
  CanFrame frame;
  plain.stamp({.software_ns = clock_.realtime_ns(), .hardware_ns = 5}, frame);
  EXPECT_EQ(frame.time_source, TimeSource::kSoftware);
}

TEST_F(FrameTimeTest, UsesTheTimeOfReadingWithoutAnyStamp) {
  clock_.advance(kMs);
  frame_time_.begin_batch(clock_, true);
  CanFrame frame;
  frame_time_.stamp({}, frame);
  EXPECT_EQ(frame.time_source, TimeSource::kUnknown);
  EXPECT_NEAR(static_cast<double>(frame.time_ns - run_time_.from_monotonic(clock_.monotonic_ns())),
              0.0, kDigitsNs);
}

TEST(RunTime, IsNotMisledByAnInterruptionBetweenTwoClocks) {
  ManualClock clock;
  const std::int64_t offset_ns = hal::RunTime::start(clock).offset_ns;
  clock.interrupt_once(kHour);
  EXPECT_EQ(hal::RunTime::start(clock).offset_ns, offset_ns);
}

TEST(SystemClock, SleepsUntilAMomentAndNotAtAllUntilOneThatIsPast) {
  const SystemClock clock;
  const std::int64_t begin_ns = clock.monotonic_ns();
  clock.sleep_until(begin_ns - 1);
  clock.sleep_until(-1);
  clock.sleep_until(begin_ns + 20 * kMs);
  EXPECT_GE(clock.monotonic_ns(), begin_ns + 20 * kMs);
  EXPECT_GT(clock.realtime_ns(), 1'600'000'000'000'000'000);
}

}  // namespace
}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#include "drivers/socketcan/frame_time.hpp"

#include <algorithm>
#include <cstdlib>

namespace dampline::drivers {
namespace {

struct Difference {
  std::int64_t wall_minus_monotonic_ns{0};
  std::int64_t uncertainty_ns{0};  // how long the reading took
};

/// The best of a few readings: a thread may be interrupted between two clocks.
Difference measure_difference(const hal::Clock& clock) noexcept {
  constexpr int kTries = 4;
  constexpr std::int64_t kGoodNs = 20'000;
  Difference best;
  for (int i = 0; i < kTries; ++i) {
    const std::int64_t before_ns = clock.monotonic_ns();
    const std::int64_t wall_ns = clock.realtime_ns();
    const std::int64_t took_ns = clock.monotonic_ns() - before_ns;
    if (i == 0 || took_ns < best.uncertainty_ns) {
      best = {wall_ns - before_ns - took_ns / 2, took_ns};
    }
    if (took_ns <= kGoodNs) break;
  }
  return best;
}

}  // namespace

std::int64_t ClockSteps::check(const hal::Clock& clock) noexcept {
  const std::int64_t known_ns = run_time_.offset_ns + total_ns_;
  const std::int64_t wall_ns = clock.realtime_ns();
  const std::int64_t monotonic_ns = clock.monotonic_ns();
  checked_at_ns_ = run_time_.from_monotonic(monotonic_ns);
  if (std::abs(wall_ns - monotonic_ns - known_ns) < kLeastStepNs) return 0;
  const Difference now = measure_difference(clock);
  const std::int64_t step_ns = now.wall_minus_monotonic_ns - known_ns;
  if (std::abs(step_ns) < kLeastStepNs + now.uncertainty_ns) return 0;
  const std::int64_t whole_ns = step_ns - step_ns % 1000;
  total_ns_ += whole_ns;
  return whole_ns;
}

namespace {

// Steps below ClockSteps::kLeastStepNs stay in the stamps.
constexpr std::int64_t kToleranceNs = ClockSteps::kLeastStepNs + 100'000;
constexpr std::int64_t kMostDriftNs = 50'000'000;
constexpr std::int64_t kFollowFrames = 1024;

std::int64_t whole_microseconds(std::int64_t time_ns) noexcept { return time_ns - time_ns % 1000; }

}  // namespace

// A frame may come between the reading of a batch and the look at the clocks behind it: what is
// known of the queue counts from the look before.
std::int64_t FrameTime::begin_batch(const hal::Clock& clock, bool drained) noexcept {
  if (drained_) {
    step_pending_ = step_pending_ && step_is_new_;
    earliest_ns_ = next_earliest_ns_;
  }
  drained_ = drained;
  next_earliest_ns_ = steps_.checked_at_ns();
  const std::int64_t before_ns = steps_.total_ns();
  const std::int64_t step_ns = steps_.check(clock);
  step_is_new_ = step_ns != 0;
  if (step_is_new_) {
    step_pending_ = true;
    before_ns_ = before_ns;
  }
  return step_ns;
}

/// From the times at which a frame of this batch can have come.
std::int64_t FrameTime::distance_ns(std::int64_t time_ns) const noexcept {
  const std::int64_t earliest_ns = std::max(earliest_ns_, newest_ns_) - kToleranceNs;
  const std::int64_t latest_ns = steps_.checked_at_ns() + kToleranceNs;
  return std::max({earliest_ns - time_ns, time_ns - latest_ns, std::int64_t{0}});
}

// Where both are possible the later is taken: a frame is read soon after it was stamped.
std::int64_t FrameTime::software_time_ns(std::int64_t stamp_ns) noexcept {
  const std::int64_t after_ns = stamp_ns - steps_.total_ns();
  if (!step_pending_) return after_ns;
  const std::int64_t before_ns = stamp_ns - before_ns_;
  const std::int64_t far_before_ns = distance_ns(before_ns);
  const std::int64_t far_after_ns = distance_ns(after_ns);
  if (far_before_ns == far_after_ns) return std::max(before_ns, after_ns);
  if (far_before_ns < far_after_ns) return before_ns;
  if (far_after_ns == 0) step_pending_ = false;  // the queue keeps its order
  return after_ns;
}

std::int64_t FrameTime::hardware_time_ns(std::int64_t stamp_ns, std::int64_t software_ns) noexcept {
  const std::int64_t apart_ns = software_ns - (stamp_ns + tie_ns_);
  if (!tied_ || std::abs(apart_ns) > kMostDriftNs) {
    tied_ = true;
    tie_ns_ = software_ns - stamp_ns;
  } else {
    tie_ns_ += apart_ns / kFollowFrames;
  }
  return stamp_ns + tie_ns_;
}

void FrameTime::stamp(const FrameStamp& stamp, CanFrame& frame) noexcept {
  const std::int64_t now_ns = steps_.checked_at_ns();
  std::int64_t time_ns = now_ns;
  frame.time_source = TimeSource::kUnknown;
  if (stamp.software_ns != 0) {
    time_ns = software_time_ns(whole_microseconds(stamp.software_ns));
    frame.time_source = TimeSource::kSoftware;
  }
  if (hardware_ && stamp.hardware_ns != 0) {
    time_ns = hardware_time_ns(stamp.hardware_ns, time_ns);
    frame.time_source = TimeSource::kHardware;
  }
  // Past now lies only what a clock said that was set to and fro between two batches.
  const bool future = time_ns > now_ns + kMostDriftNs;
  if (future) time_ns = now_ns;
  if (future || time_ns < newest_ns_) ++reordered_;
  newest_ns_ = std::max(newest_ns_, time_ns);
  frame.time_ns = whole_microseconds(newest_ns_);
}

}  // namespace dampline::drivers

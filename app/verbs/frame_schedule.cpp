// SPDX-License-Identifier: MIT
#include "app/verbs/frame_schedule.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::app {

void FrameSchedule::start(std::int64_t first_ns) noexcept {
  if (started_) return;
  started_ = true;
  first_ns_ = first_ns;
  start_ns_ = clock_.monotonic_ns();
}

std::int64_t FrameSchedule::due_ns(std::int64_t time_ns) const noexcept {
  const std::int64_t since_ns = time_ns - first_ns_;
  if (speed_ == 0.0) return start_ns_;
  if (speed_ == 1.0) return start_ns_ + since_ns;
  return start_ns_ + std::llround(static_cast<double>(since_ns) / speed_);
}

// In slices: a signal that comes just before a sleep does not cut it short.
bool FrameSchedule::wait_for(std::int64_t time_ns, const StopRequest& stop) const noexcept {
  constexpr std::int64_t kSliceNs = 100'000'000;
  if (speed_ == 0.0) return !stop.made();
  const std::int64_t due = due_ns(time_ns);
  while (!stop.made()) {
    const std::int64_t now_ns = clock_.monotonic_ns();
    if (now_ns >= due) return true;
    clock_.sleep_until(std::min(due, now_ns + kSliceNs));
  }
  return false;
}

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include "drivers/socketcan/clock_steps.hpp"

#include <cstdlib>

namespace dampline::drivers {
namespace {

struct Difference {
  std::int64_t wall_minus_monotonic_ns{0};
  std::int64_t uncertainty_ns{0};  // how long the reading took
};

/// The best of a few readings: a thread may be interrupted between two clocks.
Difference measure(const hal::Clock& clock) noexcept {
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
  const Difference now = measure(clock);
  const std::int64_t step_ns = now.wall_minus_monotonic_ns - known_ns;
  if (std::abs(step_ns) < kLeastStepNs + now.uncertainty_ns) return 0;
  const std::int64_t whole_ns = step_ns - step_ns % 1000;
  total_ns_ += whole_ns;
  return whole_ns;
}

}  // namespace dampline::drivers

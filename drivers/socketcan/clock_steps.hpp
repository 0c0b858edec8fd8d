// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "hal/clock.hpp"

namespace dampline::drivers {

/// By how much the wall clock was set since the run began. Wall clock and monotonic clock are
/// slewed together, so their difference changes by steps alone.
class ClockSteps {
 public:
  /// A smaller change is taken for the noise of reading two clocks; several add up until they pass.
  static constexpr std::int64_t kLeastStepNs = 1'000'000;

  explicit ClockSteps(hal::RunTime run_time) noexcept : run_time_{run_time} {}
  /// The step since the last check, in whole microseconds, or 0. Reads each clock once, and again
  /// only where the difference has changed.
  [[nodiscard]] std::int64_t check(const hal::Clock& clock) noexcept;
  /// All steps so far: wall clock = run time + this.
  [[nodiscard]] std::int64_t total_ns() const noexcept { return total_ns_; }
  /// Run time at the last check.
  [[nodiscard]] std::int64_t checked_at_ns() const noexcept { return checked_at_ns_; }

 private:
  hal::RunTime run_time_;
  std::int64_t total_ns_{0};
  std::int64_t checked_at_ns_{0};
};

}  // namespace dampline::drivers

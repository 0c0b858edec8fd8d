// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "hal/clock.hpp"

namespace dampline {

/// Clocks that stand until they are moved. A sleep moves them.
class ManualClock final : public hal::Clock {
 public:
  static constexpr std::int64_t kStartMonotonicNs = 5'000'000'000'123;
  static constexpr std::int64_t kStartRealtimeNs = 1'700'000'000'000'000'789;

  void advance(std::int64_t time_ns) noexcept { elapsed_ns_ += time_ns; }
  void step_wall(std::int64_t step_ns) noexcept { stepped_ns_ += step_ns; }
  /// The next reading of the wall clock is followed by so long a break.
  void interrupt_once(std::int64_t time_ns) noexcept { interruption_ns_ = time_ns; }

 private:
  [[nodiscard]] std::int64_t do_monotonic_ns() const noexcept override {
    return kStartMonotonicNs + elapsed_ns_;
  }
  [[nodiscard]] std::int64_t do_realtime_ns() const noexcept override {
    const std::int64_t now_ns = kStartRealtimeNs + elapsed_ns_ + stepped_ns_;
    elapsed_ns_ += interruption_ns_;
    interruption_ns_ = 0;
    return now_ns;
  }
  void do_sleep_until(std::int64_t monotonic_ns) const noexcept override {
    if (monotonic_ns > do_monotonic_ns()) elapsed_ns_ = monotonic_ns - kStartMonotonicNs;
  }
  mutable std::int64_t elapsed_ns_{0};
  mutable std::int64_t interruption_ns_{0};
  std::int64_t stepped_ns_{0};
};

}  // namespace dampline

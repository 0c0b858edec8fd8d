// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

namespace dampline::hal {

inline constexpr std::int64_t kSecondNs = 1'000'000'000;

/// The only way to the time of day. Contract: monotonic_ns() never goes back; realtime_ns() may
/// jump.
class Clock {
 public:
  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  virtual ~Clock() = default;
  [[nodiscard]] std::int64_t monotonic_ns() const noexcept { return do_monotonic_ns(); }
  /// Since 1970, UTC.
  [[nodiscard]] std::int64_t realtime_ns() const noexcept { return do_realtime_ns(); }
  /// Returns at once where that moment is past; early where a signal arrives.
  void sleep_until(std::int64_t monotonic_ns) const noexcept { do_sleep_until(monotonic_ns); }

 private:
  [[nodiscard]] virtual std::int64_t do_monotonic_ns() const noexcept = 0;
  [[nodiscard]] virtual std::int64_t do_realtime_ns() const noexcept = 0;
  virtual void do_sleep_until(std::int64_t monotonic_ns) const noexcept = 0;
};

/// Run time: the wall clock as it stood when the run began, going on without steps. All sources of
/// one run share it, so that their times compare. run time = monotonic time + offset.
struct RunTime {
  std::int64_t offset_ns{0};  ///< whole microseconds, so that times keep their digits in text

  /// The best of a few readings: a thread may be interrupted between the two clocks.
  [[nodiscard]] static RunTime start(const Clock& clock) noexcept {
    constexpr int kReadings = 8;
    std::int64_t offset_ns = 0;
    std::int64_t shortest_ns = 0;
    for (int i = 0; i < kReadings; ++i) {
      const std::int64_t before_ns = clock.monotonic_ns();
      const std::int64_t wall_ns = clock.realtime_ns();
      const std::int64_t took_ns = clock.monotonic_ns() - before_ns;
      if (i > 0 && took_ns >= shortest_ns) continue;
      shortest_ns = took_ns;
      offset_ns = wall_ns - before_ns - took_ns / 2;
    }
    return {offset_ns - offset_ns % 1000};
  }
  [[nodiscard]] std::int64_t from_monotonic(std::int64_t monotonic_ns) const noexcept {
    return monotonic_ns + offset_ns;
  }
};

}  // namespace dampline::hal

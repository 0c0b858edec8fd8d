// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

namespace dampline::hal {

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

  [[nodiscard]] static RunTime start(const Clock& clock) noexcept {
    const std::int64_t offset_ns = clock.realtime_ns() - clock.monotonic_ns();
    return {offset_ns - offset_ns % 1000};
  }
  [[nodiscard]] std::int64_t from_monotonic(std::int64_t monotonic_ns) const noexcept {
    return monotonic_ns + offset_ns;
  }
};

}  // namespace dampline::hal

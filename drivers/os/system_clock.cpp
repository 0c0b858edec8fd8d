// SPDX-License-Identifier: MIT
#include "drivers/os/system_clock.hpp"

#include <ctime>

namespace dampline::drivers {
namespace {

std::int64_t read_clock(clockid_t id) noexcept {
  timespec now{};
  static_cast<void>(::clock_gettime(id, &now));  // cannot fail for these two clocks
  return static_cast<std::int64_t>(now.tv_sec) * hal::kSecondNs + now.tv_nsec;
}

}  // namespace

std::int64_t SystemClock::do_monotonic_ns() const noexcept { return read_clock(CLOCK_MONOTONIC); }

std::int64_t SystemClock::do_realtime_ns() const noexcept { return read_clock(CLOCK_REALTIME); }

void SystemClock::do_sleep_until(std::int64_t monotonic_ns) const noexcept {
  if (monotonic_ns <= 0) return;
  timespec until{};
  until.tv_sec = static_cast<time_t>(monotonic_ns / hal::kSecondNs);
  until.tv_nsec = static_cast<long>(monotonic_ns % hal::kSecondNs);  // NOLINT the type of tv_nsec
  static_cast<void>(::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr));
}

}  // namespace dampline::drivers

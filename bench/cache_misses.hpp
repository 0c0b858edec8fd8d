// SPDX-License-Identifier: MIT
#pragma once
#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <optional>

namespace dampline::bench {

/// Misses of the last cache by this thread, where the machine lets a program count them.
class CacheMisses {
 public:
  explicit CacheMisses(std::uint32_t type = PERF_TYPE_HARDWARE,
                       std::uint64_t event = PERF_COUNT_HW_CACHE_MISSES) noexcept {
    perf_event_attr wanted{};
    wanted.type = type;
    wanted.size = sizeof wanted;
    wanted.config = event;
    wanted.disabled = 1;
    wanted.exclude_kernel = 1;
    wanted.exclude_hv = 1;
    counter_ = static_cast<int>(::syscall(SYS_perf_event_open, &wanted, 0, -1, -1, 0));
  }
  ~CacheMisses() {
    if (counter_ >= 0) ::close(counter_);
  }
  CacheMisses(const CacheMisses&) = delete;
  CacheMisses& operator=(const CacheMisses&) = delete;

  void start() const noexcept {
    if (counter_ < 0) return;
    ::ioctl(counter_, PERF_EVENT_IOC_RESET, 0);
    ::ioctl(counter_, PERF_EVENT_IOC_ENABLE, 0);
  }
  /// Since start(); nothing where they cannot be counted.
  [[nodiscard]] std::optional<std::uint64_t> stop() const noexcept {
    std::uint64_t count = 0;
    if (counter_ < 0 || ::ioctl(counter_, PERF_EVENT_IOC_DISABLE, 0) != 0 ||
        ::read(counter_, &count, sizeof count) != static_cast<ssize_t>(sizeof count))
      return std::nullopt;
    return count;
  }

 private:
  int counter_{-1};
};

}  // namespace dampline::bench

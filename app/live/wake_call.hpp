// SPDX-License-Identifier: MIT
#pragma once
#include <semaphore.h>

#include <cerrno>
#include <chrono>
#include <ctime>

namespace dampline::app {

/// Wakes another thread. Calling never waits. The semaphore of the C library sleeps in the kernel
/// at once; the one of the C++ library first watches the clock for a while, which a real-time
/// system can do without.
class WakeCall {
 public:
  WakeCall() noexcept { ::sem_init(&semaphore_, 0, 0); }
  WakeCall(const WakeCall&) = delete;
  WakeCall& operator=(const WakeCall&) = delete;
  ~WakeCall() { ::sem_destroy(&semaphore_); }

  void call() noexcept { ::sem_post(&semaphore_); }
  /// Until the next call, one that came before included, or the time is over.
  void wait(std::chrono::nanoseconds most) noexcept {
    constexpr long kSecond = 1'000'000'000;
    timespec until{};
    ::clock_gettime(CLOCK_MONOTONIC, &until);
    const auto ns = static_cast<long>(most.count()) + until.tv_nsec;
    until.tv_sec += ns / kSecond;
    until.tv_nsec = ns % kSecond;
    while (::sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &until) != 0 && errno == EINTR) continue;
    while (::sem_trywait(&semaphore_) == 0) continue;  // calls in between are answered as well
  }

 private:
  sem_t semaphore_{};
};

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <chrono>
#include <csignal>
#include <cstdint>

namespace dampline::app {

enum class SignalSeen : std::uint8_t { kNone, kStop, kRotate };

/// Takes SIGINT, SIGTERM and SIGHUP out of the blue into wait(). Make it before any thread, so that
/// all threads inherit it. When it goes, a further signal ends the program as usual.
class Signals {
 public:
  Signals() noexcept;
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  ~Signals();
  /// Sleeps until a signal arrives or the time is over.
  [[nodiscard]] SignalSeen wait(std::chrono::nanoseconds timeout) const noexcept;

 private:
  sigset_t wanted_{};
  sigset_t before_{};
};

}  // namespace dampline::app

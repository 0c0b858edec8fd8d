// SPDX-License-Identifier: MIT
#include "app/live/signals.hpp"

#include <ctime>

namespace dampline::app {

Signals::Signals() noexcept {
  ::sigemptyset(&wanted_);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&wanted_, number);
  ::pthread_sigmask(SIG_BLOCK, &wanted_, &before_);
}

Signals::~Signals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

SignalSeen Signals::wait(std::chrono::nanoseconds timeout) const noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const timespec limit{timeout.count() / kSecond, timeout.count() % kSecond};
  switch (::sigtimedwait(&wanted_, nullptr, &limit)) {
    case SIGINT:
    case SIGTERM:
      return SignalSeen::kStop;
    case SIGHUP:
      return SignalSeen::kRotate;
    default:
      return SignalSeen::kNone;
  }
}

}  // namespace dampline::app

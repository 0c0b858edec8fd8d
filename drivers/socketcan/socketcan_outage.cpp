// SPDX-License-Identifier: MIT
// Waiting, and what happens while the interface is down or away.
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <utility>

#include "drivers/socketcan/socketcan_source.hpp"

namespace dampline::drivers {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;
constexpr std::int64_t kLookEveryNs = 200'000'000;
constexpr std::int64_t kPollFailedNs = 10'000'000;

}  // namespace

Result<bool> SocketCanSource::do_wait(std::chrono::nanoseconds timeout) noexcept {
  const std::int64_t deadline_ns = clock_.monotonic_ns() + timeout.count();
  std::int64_t left_ns = timeout.count();
  const bool away = !health_.link_up;
  do {
    if (away) watch_outage();
    if (away && health_.link_up) return true;
    const Poll polled = poll_for(away ? std::min(left_ns, kLookEveryNs) : left_ns);
    if (polled == Poll::kReady) return true;
    if (polled == Poll::kInterrupted) return false;
    if (polled == Poll::kFailed) {  // so read() has to be tried instead, but not without a pause
      clock_.sleep_until(std::min(deadline_ns, clock_.monotonic_ns() + kPollFailedNs));
      return true;
    }
    left_ns = deadline_ns - clock_.monotonic_ns();
  } while (left_ns > 0);
  return take_silent_drops();
}

SocketCanSource::Poll SocketCanSource::poll_for(std::int64_t time_ns) noexcept {
  time_ns = std::max<std::int64_t>(time_ns, 0);
  timespec left{};
  left.tv_sec = static_cast<time_t>(time_ns / kSecondNs);
  left.tv_nsec = static_cast<long>(time_ns % kSecondNs);  // NOLINT the type of tv_nsec
  pollfd entry{.fd = socket_.file(), .events = POLLIN, .revents = 0};
  const int ready = ::ppoll(&entry, socket_.is_open() ? 1 : 0, &left, nullptr);
  if (ready > 0) return Poll::kReady;
  if (ready == 0) return Poll::kTimeout;
  if (errno == EINTR) return Poll::kInterrupted;
  refused_ = "ppoll";
  refused_errno_ = errno;
  return Poll::kFailed;
}

bool SocketCanSource::take_silent_drops() noexcept {
  if (!socket_.is_open()) return false;
  const std::uint64_t before = health_.dropped;
  take_drops(socket_.drops(drops_seen_), now());
  return health_.dropped != before;
}

bool SocketCanSource::take_failure(int error_number) noexcept {
  switch (error_number) {
    case EAGAIN:
      tell_step(frame_time_.begin_batch(clock_, true));
      if (pending_ != Outage::kNone) begin_outage();
      return false;
    case ENETDOWN:
      return postpone(Outage::kDown);
    case ENODEV:
    case ENXIO:
      return postpone(Outage::kRemoved);
    default:
      break;
  }
  if (error_number == EINTR) return false;
  refused_ = "recvmmsg";
  refused_errno_ = error_number;
  if (error_number == ENOMEM || error_number == ENOBUFS) return false;  // will pass
  pending_ = Outage::kFailed;
  begin_outage();
  return false;
}

// The kernel tells an error before the frames that are still queued, and each error once.
bool SocketCanSource::postpone(Outage outage) noexcept {
  const bool again = pending_ >= outage;
  pending_ = std::max(pending_, outage);
  if (again) begin_outage();
  return !again;
}

void SocketCanSource::begin_outage() noexcept {
  const Outage outage = std::exchange(pending_, Outage::kNone);
  if (health_.link_up) {
    health_.link_up = false;
    ++health_.link_downs;
    tell(hal::EventKind::kLinkDown);
  }
  if (outage != Outage::kDown) close_socket(outage == Outage::kRemoved);
}

// The kernel does not tell a socket that its interface is up again, so it is asked.
void SocketCanSource::watch_outage() noexcept {
  const char* const interface = config_.interface.c_str();
  if (!socket_.is_open()) reopen();
  if (!socket_.is_open()) return;
  if (socket_.interface_index(interface) != interface_index_) {
    close_socket(true);
  } else if (socket_.interface_up(interface)) {
    health_.link_up = true;
    tell(hal::EventKind::kLinkUp);
  }
}

void SocketCanSource::close_socket(bool removed) noexcept {
  take_silent_drops();
  socket_.close();
  next_look_ns_ = 0;
  if (!removed || removed_) return;
  removed_ = true;
  tell(hal::EventKind::kInterfaceRemoved);
}

void SocketCanSource::reopen() noexcept {
  const std::int64_t monotonic_ns = clock_.monotonic_ns();
  if (monotonic_ns < next_look_ns_) return;
  next_look_ns_ = monotonic_ns + kLookEveryNs;
  SocketAttempt opened = attempt();
  if (opened.failed != nullptr) {
    refused_ = opened.failed;
    refused_errno_ = opened.error_number;
    return;
  }
  use(std::move(opened));
  ++health_.reopened;
  if (!std::exchange(removed_, false)) return;
  tell(hal::EventKind::kInterfaceBack);
}

}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#include "drivers/socketcan/sender.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

#include "drivers/socketcan/message.hpp"
#include "drivers/socketcan/socket.hpp"

namespace dampline::drivers {
namespace {

constexpr std::int64_t kPauseNs = 500'000;  // a classic frame at 250 kbit/s

}  // namespace

Outcome<std::unique_ptr<CanSender>> CanSender::open(const std::string& interface,
                                                    const hal::Clock& clock) {
  SocketAttempt opened = open_for_sending(interface.c_str());
  if (opened.failed != nullptr) return open_failure(interface, opened);
  return std::unique_ptr<CanSender>{new CanSender{interface, clock, std::move(opened)}};
}

CanSender::CanSender(std::string interface, const hal::Clock& clock, SocketAttempt opened) noexcept
    : interface_{std::move(interface)}, clock_{clock}, socket_{std::move(opened.socket)} {
  for (std::size_t i = 0; i < kMessages; ++i) {
    vectors_[i].iov_base = &frames_[i];
    headers_[i].msg_hdr.msg_iov = &vectors_[i];
    headers_[i].msg_hdr.msg_iovlen = 1;
  }
}

std::size_t CanSender::send(std::span<const CanFrame> frames) noexcept {
  std::size_t sent = 0;
  while (!frames.empty()) {
    const std::span<const CanFrame> part = frames.first(std::min(frames.size(), kMessages));
    sent += flush(fill(part));
    frames = frames.subspan(part.size());
  }
  return sent;
}

/// What is no frame is left out.
std::size_t CanSender::fill(std::span<const CanFrame> frames) noexcept {
  std::size_t count = 0;
  for (const CanFrame& frame : frames) {
    vectors_[count].iov_len = to_wire(frame, frames_[count]);
    if (vectors_[count].iov_len != 0) {
      ++count;
    } else {
      ++health_.not_sent;
      last_errno_ = EINVAL;
    }
  }
  return count;
}

std::size_t CanSender::flush(std::size_t count) noexcept {
  std::size_t done = 0;
  std::size_t sent = 0;
  int failures = 0;  // since a frame went out
  std::int64_t give_up_ns = 0;
  while (done < count) {
    const bool open = socket_.is_open() || reopen();
    const int taken = open ? ::sendmmsg(socket_.file(), &headers_[done],
                                        static_cast<unsigned>(count - done), MSG_DONTWAIT)
                           : -1;
    if (taken > 0) {
      done += static_cast<std::size_t>(taken);
      sent += static_cast<std::size_t>(taken);
      failures = 0;
      continue;
    }
    const Verdict verdict = judge(open && taken < 0 ? errno : ENODEV, ++failures, give_up_ns);
    if (verdict == Verdict::kGiveUp) break;
    if (verdict == Verdict::kSkipOne) {
      ++done;
      failures = 0;
    }
  }
  health_.sent += sent;
  health_.not_sent += count - sent;
  return sent;
}

// An error that was left behind by an outage is told with the next call, so one failure is none.
CanSender::Verdict CanSender::judge(int error_number, int failures,
                                    std::int64_t& give_up_ns) noexcept {
  constexpr int kMostInterruptions = 1000;
  last_errno_ = error_number;
  switch (error_number) {
    case EINTR:
      return failures < kMostInterruptions ? Verdict::kRetry : Verdict::kGiveUp;
    case EAGAIN:
    case ENOBUFS:
    case ENOMEM:
      if (give_up_ns == 0) give_up_ns = clock_.monotonic_ns() + kPatienceNs;
      if (clock_.monotonic_ns() >= give_up_ns) return Verdict::kGiveUp;
      ++health_.retries;
      pause();
      return Verdict::kRetry;
    case ENETDOWN:
      return failures < 2 ? Verdict::kRetry : Verdict::kGiveUp;
    case EINVAL:  // CAN FD, and the interface is not for it
    case EMSGSIZE:
      return Verdict::kSkipOne;
    default:
      socket_.close();
      return failures < 2 ? Verdict::kRetry : Verdict::kGiveUp;
  }
}

// poll() does not tell when a transmit queue (ENOBUFS) has room.
void CanSender::pause() noexcept { clock_.sleep_until(clock_.monotonic_ns() + kPauseNs); }

bool CanSender::reopen() noexcept {
  const std::int64_t monotonic_ns = clock_.monotonic_ns();
  if (monotonic_ns < next_look_ns_) return false;
  next_look_ns_ = monotonic_ns + kLookEveryNs;
  SocketAttempt opened = open_for_sending(interface_.c_str());
  if (opened.failed != nullptr) return false;
  socket_ = std::move(opened.socket);
  ++health_.reopened;
  return true;
}

}  // namespace dampline::drivers

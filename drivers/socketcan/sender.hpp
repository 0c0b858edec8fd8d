// SPDX-License-Identifier: MIT
#pragma once
#include <linux/can.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "dampline/can_frame.hpp"
#include "drivers/outcome.hpp"
#include "drivers/socketcan/socket.hpp"
#include "hal/clock.hpp"

namespace dampline::drivers {

/// Monotone counters.
struct SenderHealth {
  std::uint64_t sent{0};      ///< taken by the kernel
  std::uint64_t not_sent{0};  ///< given up: interface down, away, full for too long, or no frame
  std::uint64_t retries{0};   ///< the kernel's queue was full and was waited for
  std::uint64_t reopened{0};  ///< a new socket, because the interface had been removed
};

/// Sends frames on a CAN interface, many with one system call.
class CanSender {
 public:
  /// `clock` must outlive the sender.
  static Outcome<std::unique_ptr<CanSender>> open(const std::string& interface,
                                                  const hal::Clock& clock);

  /// Sends in order and returns how many the kernel took. A full queue is waited for, up to
  /// kPatienceNs in all; what cannot be sent is counted and left out, as a sensor does.
  std::size_t send(std::span<const CanFrame> frames) noexcept;
  [[nodiscard]] const SenderHealth& health() const noexcept { return health_; }
  /// What the kernel refused last; 0: nothing yet.
  [[nodiscard]] int last_errno() const noexcept { return last_errno_; }

  static constexpr std::int64_t kPatienceNs = 100'000'000;

 private:
  static constexpr std::size_t kMessages = 1024;
  enum class Verdict : std::uint8_t { kRetry, kSkipOne, kGiveUp };

  CanSender(std::string interface, const hal::Clock& clock, SocketAttempt opened) noexcept;
  [[nodiscard]] std::size_t fill(std::span<const CanFrame> frames) noexcept;
  /// Returns how many of the first `count` messages went out.
  [[nodiscard]] std::size_t flush(std::size_t count) noexcept;
  [[nodiscard]] Verdict judge(int error_number, int failures, std::int64_t& give_up_ns) noexcept;
  [[nodiscard]] bool reopen() noexcept;
  void pause() noexcept;

  std::string interface_;
  const hal::Clock& clock_;
  CanSocket socket_;
  std::int64_t next_look_ns_{0};
  int last_errno_{0};
  SenderHealth health_{};
  std::array<mmsghdr, kMessages> headers_{};
  std::array<iovec, kMessages> vectors_{};
  std::array<canfd_frame, kMessages> frames_{};
};

}  // namespace dampline::drivers

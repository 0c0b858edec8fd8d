// SPDX-License-Identifier: MIT
#pragma once
#include <linux/can.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "dampline/can_frame.hpp"
#include "drivers/socketcan/frame_time.hpp"
#include "hal/event.hpp"

namespace dampline::drivers {

/// A frame as the kernel hands it over, `bytes` long. False: no frame (wrong size or length). The
/// time is left alone.
[[nodiscard]] bool from_wire(const canfd_frame& wire, std::size_t bytes, CanFrame& frame) noexcept;

/// Returns how many bytes of `wire` to hand to the kernel; 0: no frame of this form exists.
[[nodiscard]] std::size_t to_wire(const CanFrame& frame, canfd_frame& wire) noexcept;

/// What one error frame tells, in this order: bus-off, other errors, restart.
struct ErrorEvents {
  std::array<hal::Event, 3> events{};
  std::size_t count{0};
};
[[nodiscard]] ErrorEvents error_events(const CanFrame& frame) noexcept;

/// What the kernel says beside a frame.
struct MessageInfo {
  FrameStamp stamp{};
  std::optional<std::uint32_t> drops{};  ///< of this socket so far; absent: as before
};
[[nodiscard]] MessageInfo read_info(msghdr& header) noexcept;

/// Fixed arrays for recvmmsg.
class MessageBatch {
 public:
  static constexpr std::size_t kMessages = 64;

  MessageBatch() noexcept;
  MessageBatch(const MessageBatch&) = delete;
  MessageBatch& operator=(const MessageBatch&) = delete;
  ~MessageBatch() = default;
  /// The first `count` headers with their lengths as they must be before every call.
  [[nodiscard]] std::span<mmsghdr> prepare(std::size_t count) noexcept;
  [[nodiscard]] const canfd_frame& frame(std::size_t i) const noexcept { return frames_[i]; }
  [[nodiscard]] std::size_t bytes(std::size_t i) const noexcept { return headers_[i].msg_len; }
  [[nodiscard]] MessageInfo info(std::size_t i) noexcept { return read_info(headers_[i].msg_hdr); }

 private:
  struct alignas(cmsghdr) Control {
    std::array<std::byte, 128> bytes{};
  };
  std::array<mmsghdr, kMessages> headers_{};
  std::array<iovec, kMessages> vectors_{};
  std::array<canfd_frame, kMessages> frames_{};
  std::array<Control, kMessages> controls_{};
};

}  // namespace dampline::drivers

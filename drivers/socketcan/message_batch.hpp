// SPDX-License-Identifier: MIT
#pragma once
#include <linux/can.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/socketcan/frame_time.hpp"

namespace dampline::drivers {

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

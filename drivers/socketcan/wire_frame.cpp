// SPDX-License-Identifier: MIT
#include "drivers/socketcan/wire_frame.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace dampline::drivers {
namespace {

constexpr std::uint8_t kFlags = 0x0F;  // as many as candump writes
// CAN FD pads a payload to the next of these.
constexpr std::array<std::uint8_t, 7> kLongLengths{12, 16, 20, 24, 32, 48, 64};

std::uint8_t padded_fd_length(std::uint8_t length) noexcept {
  if (length <= CAN_MAX_DLEN) return length;
  return *std::ranges::lower_bound(kLongLengths, length);
}

}  // namespace

bool from_wire(const canfd_frame& wire, std::size_t bytes, CanFrame& frame) noexcept {
  const bool fd = bytes == CANFD_MTU;
  if (!fd && bytes != CAN_MTU) return false;
  if (wire.len > (fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN)) return false;
  frame = CanFrame{};
  frame.fd = fd;
  if (fd) frame.fd_flags = wire.flags & kFlags;
  frame.length = wire.len;
  frame.error = (wire.can_id & CAN_ERR_FLAG) != 0;
  frame.extended = !frame.error && (wire.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = !frame.error && (wire.can_id & CAN_RTR_FLAG) != 0;
  frame.id = wire.can_id & (frame.error || frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  if (!frame.remote) std::copy_n(&wire.data[0], frame.length, frame.data.begin());
  return true;
}

std::size_t to_wire(const CanFrame& frame, canfd_frame& wire) noexcept {
  if (frame.length > (frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN)) return 0;
  if (frame.id > (frame.extended || frame.error ? CAN_EFF_MASK : CAN_SFF_MASK)) return 0;
  wire = canfd_frame{};
  wire.can_id = frame.id;
  if (frame.extended) wire.can_id |= CAN_EFF_FLAG;
  if (frame.remote) wire.can_id |= CAN_RTR_FLAG;
  if (frame.error) wire.can_id |= CAN_ERR_FLAG;
  if (frame.fd) wire.flags = frame.fd_flags & kFlags;
  wire.len = frame.fd ? padded_fd_length(frame.length) : frame.length;
  if (!frame.remote) std::copy_n(frame.data.begin(), frame.length, &wire.data[0]);
  return frame.fd ? CANFD_MTU : CAN_MTU;
}

}  // namespace dampline::drivers

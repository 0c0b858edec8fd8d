// SPDX-License-Identifier: MIT
#include "drivers/socketcan/message.hpp"

#include <linux/can/error.h>
#include <linux/errqueue.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <ctime>

namespace dampline::drivers {
namespace {

constexpr std::uint8_t kFdFlags = 0x0F;  // as many as candump writes
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
  if (fd) frame.fd_flags = wire.flags & kFdFlags;
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
  if (frame.fd) wire.flags = frame.fd_flags & kFdFlags;
  wire.len = frame.fd ? padded_fd_length(frame.length) : frame.length;
  if (!frame.remote) std::copy_n(frame.data.begin(), frame.length, &wire.data[0]);
  return frame.fd ? CANFD_MTU : CAN_MTU;
}

ErrorEvents error_events(const CanFrame& frame) noexcept {
  ErrorEvents told;
  if (!frame.error) return told;
  const auto tell = [&](hal::EventKind kind, std::int64_t value) {
    told.events[told.count++] = {
        .time_ns = frame.time_ns, .kind = kind, .line = frame.interface_index, .value = value};
  };
  const std::uint32_t other = frame.id & ~(CAN_ERR_BUSOFF | CAN_ERR_RESTARTED);
  if ((frame.id & CAN_ERR_BUSOFF) != 0) tell(hal::EventKind::kBusOff, 0);
  if (other != 0) tell(hal::EventKind::kBusError, other);
  if ((frame.id & CAN_ERR_RESTARTED) != 0) tell(hal::EventKind::kBusRestarted, 0);
  return told;
}

namespace {

template <class T>
T control_payload(const cmsghdr& header) noexcept {
  T value{};
  if (header.cmsg_len >= CMSG_LEN(sizeof(T))) std::memcpy(&value, CMSG_DATA(&header), sizeof(T));
  return value;
}

/// 0, no stamp, where the time is none, or so far that a sum of two would overflow: before 1970 and
/// after 2106.
std::int64_t nanoseconds(std::int64_t seconds, std::int64_t rest_ns) noexcept {
  constexpr std::int64_t kMostSeconds = std::int64_t{1} << 32U;
  if (seconds < 0 || seconds >= kMostSeconds || rest_ns < 0 || rest_ns >= hal::kSecondNs) return 0;
  return seconds * hal::kSecondNs + rest_ns;
}
std::int64_t nanoseconds(const timespec& time) noexcept {
  return nanoseconds(time.tv_sec, time.tv_nsec);
}

void take_control(const cmsghdr& header, MessageInfo& info) noexcept {
  switch (header.cmsg_type) {
    case SO_TIMESTAMPING: {
      const auto stamps = control_payload<scm_timestamping>(header);
      info.stamp = {nanoseconds(stamps.ts[0]), nanoseconds(stamps.ts[2])};
      break;
    }
    case SO_TIMESTAMPNS:
      info.stamp.software_ns = nanoseconds(control_payload<timespec>(header));
      break;
    case SO_TIMESTAMP: {
      const auto time = control_payload<timeval>(header);
      constexpr std::int64_t kMostMicroseconds = 1'000'000;
      const bool is_one = time.tv_usec >= 0 && time.tv_usec < kMostMicroseconds;
      info.stamp.software_ns = is_one ? nanoseconds(time.tv_sec, time.tv_usec * 1000) : 0;
      break;
    }
    case SO_RXQ_OVFL:
      info.drops = control_payload<std::uint32_t>(header);
      break;
    default:
      break;
  }
}

}  // namespace

MessageInfo read_info(msghdr& header) noexcept {
  MessageInfo info;
  const auto* const begin = static_cast<const std::byte*>(header.msg_control);
  for (cmsghdr* at = CMSG_FIRSTHDR(&header); at != nullptr; at = CMSG_NXTHDR(&header, at)) {
    const auto place =
        static_cast<std::size_t>(reinterpret_cast<const std::byte*>(at) - begin);  // NOLINT
    if (at->cmsg_len > header.msg_controllen - place) break;  // libc looks at that of the next only
    if (at->cmsg_level == SOL_SOCKET) take_control(*at, info);
  }
  return info;
}

MessageBatch::MessageBatch() noexcept {
  for (std::size_t i = 0; i < kMessages; ++i) {
    vectors_[i].iov_base = &frames_[i];
    headers_[i].msg_hdr.msg_iov = &vectors_[i];
    headers_[i].msg_hdr.msg_iovlen = 1;
    headers_[i].msg_hdr.msg_control = &controls_[i];
  }
}

std::span<mmsghdr> MessageBatch::prepare(std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    vectors_[i].iov_len = sizeof(canfd_frame);
    headers_[i].msg_hdr.msg_namelen = 0;
    headers_[i].msg_hdr.msg_controllen = sizeof(Control);
    headers_[i].msg_hdr.msg_flags = 0;
    headers_[i].msg_len = 0;
  }
  return std::span{headers_}.first(count);
}

}  // namespace dampline::drivers

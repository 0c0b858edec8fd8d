// SPDX-License-Identifier: MIT
#include "drivers/socketcan/message_batch.hpp"

#include <linux/errqueue.h>
#include <sys/time.h>

#include <cstring>
#include <ctime>

namespace dampline::drivers {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

template <class T>
T payload(const cmsghdr& header) noexcept {
  T value{};
  if (header.cmsg_len >= CMSG_LEN(sizeof(T))) std::memcpy(&value, CMSG_DATA(&header), sizeof(T));
  return value;
}

std::int64_t nanoseconds(const timespec& time) noexcept {
  return static_cast<std::int64_t>(time.tv_sec) * kSecondNs + time.tv_nsec;
}

void take(const cmsghdr& header, MessageInfo& info) noexcept {
  switch (header.cmsg_type) {
    case SO_TIMESTAMPING: {
      const auto stamps = payload<scm_timestamping>(header);
      info.stamp = {nanoseconds(stamps.ts[0]), nanoseconds(stamps.ts[2])};
      break;
    }
    case SO_TIMESTAMPNS:
      info.stamp.software_ns = nanoseconds(payload<timespec>(header));
      break;
    case SO_TIMESTAMP: {
      const auto time = payload<timeval>(header);
      info.stamp.software_ns =
          static_cast<std::int64_t>(time.tv_sec) * kSecondNs + time.tv_usec * 1000;
      break;
    }
    case SO_RXQ_OVFL:
      info.drops = payload<std::uint32_t>(header);
      break;
    default:
      break;
  }
}

}  // namespace

MessageInfo read_info(msghdr& header) noexcept {
  MessageInfo info;
  for (cmsghdr* at = CMSG_FIRSTHDR(&header); at != nullptr; at = CMSG_NXTHDR(&header, at)) {
    if (at->cmsg_level == SOL_SOCKET) take(*at, info);
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

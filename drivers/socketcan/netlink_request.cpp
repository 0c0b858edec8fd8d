// SPDX-License-Identifier: MIT
#include <fmt/core.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "drivers/socketcan/netlink.hpp"

namespace dampline::drivers {
namespace {

struct Request {
  nlmsghdr header{};
  ifinfomsg body{};
};

Failure failure(const char* step) {
  return {Errc::kIo,
          fmt::format("the network interfaces cannot be read: {}: {}", step, std::strerror(errno))};
}

bool send_request(int file) noexcept {
  Request request;
  request.header.nlmsg_len = sizeof(request);
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST | NLM_F_DUMP;
  request.body.ifi_family = AF_UNSPEC;
  return ::send(file, &request, sizeof(request), 0) == static_cast<ssize_t>(sizeof(request));
}

/// The answer ends with a message of its own.
bool is_last(const std::byte* data, std::size_t size) noexcept {
  nlmsghdr header{};
  for (std::size_t at = 0; at + sizeof(header) <= size;) {
    std::memcpy(&header, data + at, sizeof(header));
    if (header.nlmsg_type == NLMSG_DONE || header.nlmsg_type == NLMSG_ERROR) return true;
    if (header.nlmsg_len < sizeof(header)) return true;
    at += NLMSG_ALIGN(header.nlmsg_len);
  }
  return false;
}

Outcome<std::vector<std::byte>> receive_all(int file) {
  constexpr std::size_t kPartBytes = 65536;
  std::vector<std::byte> all;
  std::vector<std::byte> part(kPartBytes);
  for (;;) {
    const ssize_t bytes = ::recv(file, part.data(), part.size(), 0);
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes <= 0) return failure("recv");
    const auto size = static_cast<std::size_t>(bytes);
    all.insert(all.end(), part.begin(), part.begin() + bytes);
    if (is_last(part.data(), size)) return all;
  }
}

}  // namespace

Outcome<std::vector<std::byte>> request_links() {
  const int file = ::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
  if (file < 0) return failure("socket");
  const timeval patience{.tv_sec = 2, .tv_usec = 0};
  static_cast<void>(::setsockopt(file, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience)));
  Outcome<std::vector<std::byte>> answer =
      send_request(file) ? receive_all(file) : Outcome<std::vector<std::byte>>{failure("send")};
  ::close(file);
  return answer;
}

}  // namespace dampline::drivers

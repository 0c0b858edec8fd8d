// SPDX-License-Identifier: MIT
#include "drivers/socketcan/link.hpp"

// Before the kernel's own headers, which then leave its names alone.
#include <net/if.h>
// All others.
#include <fmt/core.h>
#include <linux/can.h>
#include <linux/can/netlink.h>
#include <linux/if_arp.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

namespace dampline::drivers {
namespace {

using Bytes = std::span<const std::byte>;

template <class T>
std::optional<T> read_as(Bytes bytes) noexcept {
  T value{};
  if (bytes.size() < sizeof(T)) return {};
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

std::string text_of(Bytes bytes) {
  const auto* const begin = reinterpret_cast<const char*>(bytes.data());  // NOLINT bytes of text
  return {begin, std::find(begin, begin + bytes.size(), '\0')};
}

/// Calls `take(type, payload)` for each attribute.
template <class Take>
void each_attribute(Bytes bytes, Take&& take) {
  while (const auto header = read_as<rtattr>(bytes)) {
    if (header->rta_len < sizeof(rtattr) || header->rta_len > bytes.size()) return;
    const Bytes payload = bytes.first(header->rta_len).subspan(sizeof(rtattr));
    take(header->rta_type & NLA_TYPE_MASK, payload);
    bytes = bytes.subspan(std::min<std::size_t>(RTA_ALIGN(header->rta_len), bytes.size()));
  }
}

void take_controller(int type, Bytes payload, LinkState& link) {
  switch (type) {
    case IFLA_CAN_BITTIMING:
      if (const auto timing = read_as<can_bittiming>(payload)) link.bitrate = timing->bitrate;
      break;
    case IFLA_CAN_DATA_BITTIMING:
      if (const auto timing = read_as<can_bittiming>(payload)) link.data_bitrate = timing->bitrate;
      break;
    case IFLA_CAN_RESTART_MS:
      link.restart_ms = read_as<std::uint32_t>(payload);
      break;
    case IFLA_CAN_STATE:
      if (const auto state = read_as<std::uint32_t>(payload); state && *state < CAN_STATE_MAX) {
        link.state = static_cast<CanState>(*state);
      }
      break;
    default:
      break;
  }
}

void take_info(Bytes info, LinkState& link) {
  each_attribute(info, [&](int type, Bytes payload) {
    if (type == IFLA_INFO_KIND) link.kind = text_of(payload);
  });
  if (link.kind != "can") return;  // others number their attributes otherwise
  each_attribute(info, [&](int type, Bytes payload) {
    if (type != IFLA_INFO_DATA) return;
    each_attribute(payload, [&](int key, Bytes value) { take_controller(key, value, link); });
  });
}

std::optional<LinkState> parse_link(Bytes body) {
  const auto info = read_as<ifinfomsg>(body);
  if (!info || info->ifi_type != ARPHRD_CAN) return {};
  LinkState link;
  link.index = info->ifi_index;
  link.up = (info->ifi_flags & IFF_UP) != 0;
  const std::size_t begin = std::min<std::size_t>(NLMSG_ALIGN(sizeof(ifinfomsg)), body.size());
  each_attribute(body.subspan(begin), [&](int type, Bytes payload) {
    if (type == IFLA_IFNAME) link.name = text_of(payload);
    if (type == IFLA_MTU) link.fd = read_as<std::uint32_t>(payload).value_or(0) >= CANFD_MTU;
    if (type == IFLA_LINKINFO) take_info(payload, link);
  });
  return link;
}

}  // namespace

std::vector<LinkState> parse_links(Bytes messages) {
  std::vector<LinkState> links;
  while (const auto header = read_as<nlmsghdr>(messages)) {
    if (header->nlmsg_len < sizeof(nlmsghdr) || header->nlmsg_len > messages.size()) break;
    if (header->nlmsg_type == RTM_NEWLINK) {
      const Bytes body = messages.first(header->nlmsg_len).subspan(NLMSG_HDRLEN);
      if (std::optional<LinkState> link = parse_link(body)) links.push_back(std::move(*link));
    }
    messages =
        messages.subspan(std::min<std::size_t>(NLMSG_ALIGN(header->nlmsg_len), messages.size()));
  }
  return links;
}

namespace {

struct Request {
  nlmsghdr header{};
  ifinfomsg body{};
};

Failure netlink_failure(const char* step) {
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
bool is_last_answer(const std::byte* data, std::size_t size) noexcept {
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
    if (bytes <= 0) return netlink_failure("recv");
    const auto size = static_cast<std::size_t>(bytes);
    all.insert(all.end(), part.begin(), part.begin() + bytes);
    if (is_last_answer(part.data(), size)) return all;
  }
}

}  // namespace

Outcome<std::vector<std::byte>> request_links() {
  const int file = ::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
  if (file < 0) return netlink_failure("socket");
  const timeval patience{.tv_sec = 2, .tv_usec = 0};
  static_cast<void>(::setsockopt(file, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience)));
  Outcome<std::vector<std::byte>> answer =
      send_request(file) ? receive_all(file)
                         : Outcome<std::vector<std::byte>>{netlink_failure("send")};
  ::close(file);
  return answer;
}

Outcome<std::vector<LinkState>> read_links() {
  const Outcome<std::vector<std::byte>> answer = request_links();
  if (!answer.ok()) return answer.failure();
  return parse_links(answer.value());
}

Outcome<LinkState> read_link(const std::string& name) {
  const Outcome<std::vector<LinkState>> links = read_links();
  if (!links.ok()) return links.failure();
  const auto found = std::ranges::find(links.value(), name, &LinkState::name);
  if (found != links.value().end()) return *found;
  if (::if_nametoindex(name.c_str()) != 0) {
    return Failure{Errc::kInvalidConfig,
                   fmt::format("{}: is not a CAN interface; {}", name, links_text())};
  }
  return Failure{Errc::kInvalidConfig,
                 fmt::format("{}: there is no such interface; {}", name, links_text())};
}

std::string links_text() {
  const Outcome<std::vector<LinkState>> links = read_links();
  if (!links.ok()) return links.error_text();
  if (links.value().empty()) return "there is no CAN interface";
  std::string names;
  for (const LinkState& link : links.value()) {
    if (!names.empty()) names += ", ";
    names += link.name;
  }
  return "CAN interfaces are: " + names;
}

std::vector<std::string> link_warnings(const LinkState& link) {
  std::vector<std::string> warnings;
  if (!link.up) {
    warnings.push_back(fmt::format("{}: the interface is down, waiting for it (ip link set {} up)",
                                   link.name, link.name));
  }
  if (link.restart_ms == 0U) {
    warnings.push_back(fmt::format(
        "{}: restart-ms is 0: after bus-off nothing is received any more, until someone "
        "restarts it (ip link set {} type can restart-ms 100)",
        link.name, link.name));
  }
  if (link.state == CanState::kBusOff) {
    warnings.push_back(fmt::format("{}: the controller is bus-off", link.name));
  }
  return warnings;
}

}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#include <linux/can.h>
#include <linux/can/netlink.h>
#include <linux/if.h>
#include <linux/if_arp.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "drivers/socketcan/netlink.hpp"

namespace dampline::drivers {
namespace {

using Bytes = std::span<const std::byte>;

template <class T>
std::optional<T> read(Bytes bytes) noexcept {
  T value{};
  if (bytes.size() < sizeof(T)) return {};
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

std::string text(Bytes bytes) {
  const auto* const begin = reinterpret_cast<const char*>(bytes.data());  // NOLINT bytes of text
  return {begin, std::find(begin, begin + bytes.size(), '\0')};
}

/// Calls `take(type, payload)` for each attribute.
template <class Take>
void each_attribute(Bytes bytes, Take&& take) {
  while (const auto header = read<rtattr>(bytes)) {
    if (header->rta_len < sizeof(rtattr) || header->rta_len > bytes.size()) return;
    const Bytes payload = bytes.first(header->rta_len).subspan(sizeof(rtattr));
    take(header->rta_type & NLA_TYPE_MASK, payload);
    bytes = bytes.subspan(std::min<std::size_t>(RTA_ALIGN(header->rta_len), bytes.size()));
  }
}

void take_controller(int type, Bytes payload, LinkState& link) {
  switch (type) {
    case IFLA_CAN_BITTIMING:
      if (const auto timing = read<can_bittiming>(payload)) link.bitrate = timing->bitrate;
      break;
    case IFLA_CAN_DATA_BITTIMING:
      if (const auto timing = read<can_bittiming>(payload)) link.data_bitrate = timing->bitrate;
      break;
    case IFLA_CAN_RESTART_MS:
      link.restart_ms = read<std::uint32_t>(payload);
      break;
    case IFLA_CAN_STATE:
      if (const auto state = read<std::uint32_t>(payload); state && *state < CAN_STATE_MAX) {
        link.state = static_cast<CanState>(*state);
      }
      break;
    default:
      break;
  }
}

void take_info(Bytes info, LinkState& link) {
  each_attribute(info, [&](int type, Bytes payload) {
    if (type == IFLA_INFO_KIND) link.kind = text(payload);
  });
  if (link.kind != "can") return;  // others number their attributes otherwise
  each_attribute(info, [&](int type, Bytes payload) {
    if (type != IFLA_INFO_DATA) return;
    each_attribute(payload, [&](int key, Bytes value) { take_controller(key, value, link); });
  });
}

std::optional<LinkState> parse_link(Bytes body) {
  const auto info = read<ifinfomsg>(body);
  if (!info || info->ifi_type != ARPHRD_CAN) return {};
  LinkState link;
  link.index = info->ifi_index;
  link.up = (info->ifi_flags & IFF_UP) != 0;
  const std::size_t begin = std::min<std::size_t>(NLMSG_ALIGN(sizeof(ifinfomsg)), body.size());
  each_attribute(body.subspan(begin), [&](int type, Bytes payload) {
    if (type == IFLA_IFNAME) link.name = text(payload);
    if (type == IFLA_MTU) link.fd = read<std::uint32_t>(payload).value_or(0) >= CANFD_MTU;
    if (type == IFLA_LINKINFO) take_info(payload, link);
  });
  return link;
}

}  // namespace

std::vector<LinkState> parse_links(Bytes messages) {
  std::vector<LinkState> links;
  while (const auto header = read<nlmsghdr>(messages)) {
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

}  // namespace dampline::drivers

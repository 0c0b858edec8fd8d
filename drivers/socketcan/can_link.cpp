// SPDX-License-Identifier: MIT
#include "drivers/socketcan/can_link.hpp"

#include <fmt/core.h>
#include <net/if.h>

#include <algorithm>

#include "drivers/socketcan/netlink.hpp"

namespace dampline::drivers {

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

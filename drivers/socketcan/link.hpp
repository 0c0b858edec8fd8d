// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// linux/can/netlink.h, enum can_state.
enum class CanState : std::uint8_t {
  kErrorActive,
  kErrorWarning,
  kErrorPassive,
  kBusOff,
  kStopped,
  kSleeping
};

/// What the kernel says of one CAN interface. A virtual one has no controller: the last four are
/// absent.
struct LinkState {
  std::string name{};
  std::string kind{};  ///< "can", "vcan", "vxcan"; empty: the kernel does not say
  int index{0};
  bool up{false};
  bool fd{false};  ///< takes CAN FD frames
  std::optional<std::uint32_t> bitrate{};
  std::optional<std::uint32_t> data_bitrate{};
  std::optional<std::uint32_t> restart_ms{};
  std::optional<CanState> state{};
};

/// Asks rtnetlink. A Failure where there is no such interface, naming those that there are, or
/// where it is not a CAN interface.
[[nodiscard]] Outcome<LinkState> read_link(const std::string& name);
/// Every CAN interface.
[[nodiscard]] Outcome<std::vector<LinkState>> read_links();

/// "can0, vcan0", or "there is no CAN interface", to put behind a message.
[[nodiscard]] std::string links_text();
/// What a person should change before relying on the interface; nothing where all is well.
[[nodiscard]] std::vector<std::string> link_warnings(const LinkState& link);

/// The kernel's answers to a request for all interfaces, message behind message.
[[nodiscard]] Outcome<std::vector<std::byte>> request_links();
/// The CAN interfaces among them. What is cut off or malformed is left out.
[[nodiscard]] std::vector<LinkState> parse_links(std::span<const std::byte> messages);

}  // namespace dampline::drivers

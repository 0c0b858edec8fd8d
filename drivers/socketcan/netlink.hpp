// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "drivers/outcome.hpp"
#include "drivers/socketcan/can_link.hpp"

namespace dampline::drivers {

/// The kernel's answers to a request for all interfaces, message behind message.
[[nodiscard]] Outcome<std::vector<std::byte>> request_links();
/// The CAN interfaces among them. What is cut off or malformed is left out.
[[nodiscard]] std::vector<LinkState> parse_links(std::span<const std::byte> messages);

}  // namespace dampline::drivers

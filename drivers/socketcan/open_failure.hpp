// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "drivers/outcome.hpp"
#include "drivers/socketcan/can_socket.hpp"

namespace dampline::drivers {

/// Why a socket could not be opened: what was tried, what the kernel said, which interfaces there
/// are.
[[nodiscard]] Failure open_failure(const std::string& interface, const SocketAttempt& attempt);

}  // namespace dampline::drivers

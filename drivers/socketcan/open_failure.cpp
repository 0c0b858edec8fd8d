// SPDX-License-Identifier: MIT
#include "drivers/socketcan/open_failure.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <string_view>

#include "drivers/socketcan/can_link.hpp"

namespace dampline::drivers {

Failure open_failure(const std::string& interface, const SocketAttempt& attempt) {
  const std::string_view step = attempt.failed;
  const int error = attempt.error_number;
  const char* const said = std::strerror(error);
  if (step == "socket" && (error == EAFNOSUPPORT || error == EPROTONOSUPPORT)) {
    return {
        Errc::kInvalidConfig,
        fmt::format("{}: this kernel has no CAN sockets: {} (modprobe can_raw)", interface, said)};
  }
  if (step == "socket") {
    return {Errc::kIo, fmt::format("{}: no CAN socket to be had: {}", interface, said)};
  }
  if (step == "interface" || step == "bind") {
    const Outcome<LinkState> link = read_link(interface);
    if (!link.ok() && link.failure().code == Errc::kInvalidConfig) return link.failure();
  }
  if (step == "interface") {
    return {Errc::kInvalidConfig, fmt::format("{}: cannot be found: {}", interface, said)};
  }
  return {Errc::kIo, fmt::format("{}: the kernel refuses {}: {}", interface, step, said)};
}

}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#pragma once
#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace dampline::app {

/// Where a server listens.
struct Address {
  sockaddr_storage socket{};
  bool loopback{false};  ///< 127.0.0.0/8 or ::1
  [[nodiscard]] bool is_ipv6() const noexcept { return socket.ss_family == AF_INET6; }
};

/// "127.0.0.1:9464", "[::1]:9464", "localhost:0"; port 0: any that is free. Throws UsageError
/// naming `key`, what was found and what was expected.
[[nodiscard]] Address parse_address(const std::string& text, std::string_view key);

/// Of a request's Host header: whether it names this machine's loopback, whatever the port. A page
/// of another site that has its name point here cannot read what is served then.
[[nodiscard]] bool names_loopback(std::string_view host) noexcept;

/// The token in a file: its first line, at least kLeastToken characters of those that a URL needs
/// not escape. Throws UsageError naming `key` and the file.
[[nodiscard]] std::string read_token(const std::string& file, std::string_view key);
inline constexpr std::size_t kLeastToken = 16;

}  // namespace dampline::app

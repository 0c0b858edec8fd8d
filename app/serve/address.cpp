// SPDX-License-Identifier: MIT
#include "app/serve/address.hpp"

#include <fmt/format.h>
#include <netdb.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <memory>

#include "app/error.hpp"
#include "drivers/text/whole_file.hpp"

namespace dampline::app {
namespace {

struct HostAndPort {
  std::string host;
  std::string port;
};

HostAndPort split_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return {};
  HostAndPort out{text.substr(0, colon), text.substr(colon + 1)};
  const bool bracketed = out.host.front() == '[' && out.host.back() == ']';
  if (bracketed) out.host = out.host.substr(1, out.host.size() - 2);
  if (!bracketed && out.host.find(':') != std::string::npos) return {};
  return out;
}

bool is_port(const std::string& text) {
  constexpr unsigned long kMost = 65535;
  const bool digits =
      !text.empty() && text.size() <= 5 &&
      std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  return digits && std::stoul(text) <= kMost;
}

bool is_loopback(const sockaddr_storage& socket) noexcept {
  if (socket.ss_family == AF_INET) {
    sockaddr_in four{};
    std::memcpy(&four, &socket, sizeof four);
    return ntohl(four.sin_addr.s_addr) >> 24U == 127U;
  }
  sockaddr_in6 six{};
  std::memcpy(&six, &socket, sizeof six);
  return IN6_IS_ADDR_LOOPBACK(&six.sin6_addr) != 0;
}

}  // namespace

Address parse_address(const std::string& text, std::string_view key) {
  const auto [host, port] = split_address(text);
  if (host.empty() || !is_port(port))
    throw UsageError{fmt::format(
        "{}: found \"{}\", expected HOST:PORT as in 127.0.0.1:9464 or [::1]:9464", key, text)};
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int error = ::getaddrinfo(host.c_str(), port.c_str(), &hints, &list);
  if (error != 0) throw UsageError{fmt::format("{}: \"{}\": {}", key, host, ::gai_strerror(error))};
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner{list, ::freeaddrinfo};
  Address out;
  std::memcpy(&out.socket, list->ai_addr, list->ai_addrlen);
  out.loopback = is_loopback(out.socket);
  return out;
}

bool names_loopback(std::string_view host) noexcept {
  if (host.starts_with("[::1]")) return host.size() == 5 || host[5] == ':';
  host = host.substr(0, host.find(':'));
  if (host == "localhost") return true;
  if (!host.starts_with("127.")) return false;
  return std::all_of(host.begin(), host.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0 || c == '.'; });
}

std::string read_token(const std::string& file, std::string_view key) {
  constexpr std::size_t kMostBytes = 4096;
  const auto text = drivers::read_whole(file, kMostBytes);
  if (!text.ok()) throw UsageError{fmt::format("{}: {}", key, text.error_text())};
  std::string token = text.value().substr(0, text.value().find_first_of("\r\n"));
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '.' || c == '_' || c == '~';
  };
  if (token.size() < kLeastToken || !std::all_of(token.begin(), token.end(), plain))
    throw UsageError{
        fmt::format("{}: {}: expected a line of at least {} letters, digits, - . _ or ~", key, file,
                    kLeastToken)};
  return token;
}

}  // namespace dampline::app

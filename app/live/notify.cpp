// SPDX-License-Identifier: MIT
#include "app/live/notify.hpp"

#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace dampline::app {
namespace {

std::string take_variable(const char* name) {
  const char* const value = std::getenv(name);
  std::string text = value == nullptr ? "" : value;
  ::unsetenv(name);
  return text;
}

std::optional<std::int64_t> number(const std::string& text) {
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || value <= 0) return std::nullopt;
  return value;
}

}  // namespace

NotifyEnvironment NotifyEnvironment::take() {
  NotifyEnvironment environment{.socket = take_variable("NOTIFY_SOCKET"), .watchdog_ns = {}};
  const std::optional<std::int64_t> interval_us = number(take_variable("WATCHDOG_USEC"));
  const std::string process = take_variable("WATCHDOG_PID");
  const bool ours = process.empty() || number(process) == ::getpid();
  constexpr std::int64_t kMostUs = 1'000'000'000'000;  // beyond that nobody watches
  if (interval_us && ours && *interval_us <= kMostUs) environment.watchdog_ns = *interval_us * 1000;
  return environment;
}

Notifier::Notifier(const std::string& socket) {
  // A path, or with @ a name without a file.
  if (socket.size() < 2 || (socket[0] != '/' && socket[0] != '@')) return;
  if (socket.size() >= sizeof address_.sun_path) return;
  address_.sun_family = AF_UNIX;
  std::copy(socket.begin(), socket.end(), std::begin(address_.sun_path));
  if (socket[0] == '@') address_.sun_path[0] = '\0';
  address_bytes_ = static_cast<unsigned>(offsetof(sockaddr_un, sun_path) + socket.size());
  file_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  // A manager whose queue is full is waited for, but not for long.
  const timeval patience{.tv_sec = 0, .tv_usec = 500'000};
  static_cast<void>(::setsockopt(file_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience));
}

Notifier::~Notifier() {
  if (file_ >= 0) ::close(file_);
}

void Notifier::send(std::string_view message) noexcept {
  if (file_ < 0) return;
  const auto* const to = reinterpret_cast<const sockaddr*>(&address_);
  const ssize_t sent =
      ::sendto(file_, message.data(), message.size(), MSG_NOSIGNAL, to, address_bytes_);
  if (sent != static_cast<ssize_t>(message.size())) ++failures_;
}

void Notifier::ready(std::string_view status_text) noexcept {
  send("READY=1");
  status(status_text);
}

void Notifier::status(std::string_view text) noexcept {
  constexpr std::string_view kKey = "STATUS=";
  std::array<char, 512> message{};
  std::copy(kKey.begin(), kKey.end(), message.begin());
  const std::size_t room = message.size() - kKey.size();
  const std::string_view line = text.substr(0, std::min(text.find('\n'), room));
  std::copy(line.begin(), line.end(), message.begin() + kKey.size());
  send({message.data(), kKey.size() + line.size()});
}

void Notifier::reloading() noexcept { send("RELOADING=1"); }
void Notifier::stopping() noexcept { send("STOPPING=1"); }
void Notifier::watchdog() noexcept { send("WATCHDOG=1"); }

Watchdog::Watchdog(Notifier& notifier, std::optional<std::int64_t> timeout_ns) noexcept
    : notifier_{notifier} {
  if (timeout_ns) interval_ns_ = *timeout_ns / 4;
}

void Watchdog::look(std::uint64_t turns, std::int64_t monotonic_ns) noexcept {
  if (!interval_ns_ || turns == turns_ || monotonic_ns < next_ns_) return;
  turns_ = turns;
  next_ns_ = monotonic_ns + *interval_ns_;
  notifier_.watchdog();
  ++feeds_;
}

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include "drivers/socketcan/socket.hpp"

#include <fmt/core.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/net_tstamp.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "drivers/socketcan/link.hpp"

namespace dampline::drivers {

std::vector<can_filter> make_filters(std::span<const Identifier> identifiers) {
  std::vector<can_filter> filters;
  filters.reserve(identifiers.size());
  for (const Identifier& wanted : identifiers) {
    const std::uint32_t bits = wanted.extended ? CAN_EFF_MASK : CAN_SFF_MASK;
    const std::uint32_t format = wanted.extended ? CAN_EFF_FLAG : 0U;
    filters.push_back(
        {.can_id = (wanted.id & bits) | format, .can_mask = bits | CAN_EFF_FLAG | CAN_RTR_FLAG});
  }
  const auto less = [](const can_filter& a, const can_filter& b) { return a.can_id < b.can_id; };
  const auto same = [](const can_filter& a, const can_filter& b) { return a.can_id == b.can_id; };
  std::sort(filters.begin(), filters.end(), less);
  filters.erase(std::unique(filters.begin(), filters.end(), same), filters.end());
  return filters;
}

namespace {

ifreq request_for(const char* interface) noexcept {
  ifreq request{};
  std::strncpy(&request.ifr_name[0], interface, IFNAMSIZ - 1);
  return request;
}

template <class T>
bool set_option(int file, int level, int name, const T& value) noexcept {
  return ::setsockopt(file, level, name, &value, sizeof(value)) == 0;
}

bool set_filters(int file, std::span<const can_filter> filters) noexcept {
  if (filters.empty() || filters.size() > kMostFilters) return true;
  return ::setsockopt(file, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                      static_cast<socklen_t>(filters.size_bytes())) == 0;
}

/// A kernel or controller without CAN FD is no failure.
bool allow_fd(int file) noexcept {
  return set_option(file, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, 1) || errno == ENOPROTOOPT;
}

int grow_receive_buffer(int file, int bytes) noexcept {
  // Beyond the system's limit with the privilege, up to it without. Neither is needed to work.
  if (bytes > 0 && !set_option(file, SOL_SOCKET, SO_RCVBUFFORCE, bytes)) {
    static_cast<void>(set_option(file, SOL_SOCKET, SO_RCVBUF, bytes));
  }
  int granted = 0;
  socklen_t size = sizeof(granted);
  static_cast<void>(::getsockopt(file, SOL_SOCKET, SO_RCVBUF, &granted, &size));
  return granted;
}

bool ask_for_stamps(int file, bool hardware) noexcept {
  const int software = SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE;
  const int both = software | SOF_TIMESTAMPING_RX_HARDWARE | SOF_TIMESTAMPING_RAW_HARDWARE;
  return set_option(file, SOL_SOCKET, SO_TIMESTAMPING, hardware ? both : software) ||
         set_option(file, SOL_SOCKET, SO_TIMESTAMPNS, 1) ||
         set_option(file, SOL_SOCKET, SO_TIMESTAMP, 1);
}

SocketAttempt new_socket() noexcept {
  SocketAttempt attempt;
  attempt.socket = CanSocket{::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW)};
  if (!attempt.socket.is_open()) attempt.failed = "socket";
  return attempt;
}

void bind_to(const char* interface, SocketAttempt& attempt) noexcept {
  attempt.interface_index = attempt.socket.interface_index(interface);
  if (attempt.interface_index == 0) {
    attempt.failed = "interface";
    return;
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = attempt.interface_index;
  const auto* const plain = reinterpret_cast<const sockaddr*>(&address);  // NOLINT as bind wants it
  if (::bind(attempt.socket.file(), plain, sizeof(address)) != 0) attempt.failed = "bind";
}

/// In candump's order. Returns the step that failed, or null.
const char* prepare_receiving(const ReceiveOptions& options, SocketAttempt& attempt) noexcept {
  const int file = attempt.socket.file();
  const can_err_mask_t every_error = CAN_ERR_MASK;
  if (!set_filters(file, options.filters)) return "CAN_RAW_FILTER";
  if (!set_option(file, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, every_error)) return "CAN_RAW_ERR_FILTER";
  if (!allow_fd(file)) return "CAN_RAW_FD_FRAMES";
  attempt.receive_buffer_bytes = grow_receive_buffer(file, options.receive_buffer_bytes);
  if (!ask_for_stamps(file, options.hardware_times)) return "SO_TIMESTAMP";
  if (!set_option(file, SOL_SOCKET, SO_RXQ_OVFL, 1)) return "SO_RXQ_OVFL";
  return nullptr;
}

const char* prepare_sending(int file) noexcept {
  if (::setsockopt(file, SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0) != 0) return "CAN_RAW_FILTER";
  return allow_fd(file) ? nullptr : "CAN_RAW_FD_FRAMES";
}

/// Closes what was opened where a step failed.
SocketAttempt closed_where_failed(SocketAttempt attempt) noexcept {
  if (attempt.failed == nullptr) return attempt;
  attempt.error_number = errno;
  attempt.socket.close();
  return attempt;
}

}  // namespace

CanSocket::CanSocket(CanSocket&& other) noexcept : file_{std::exchange(other.file_, -1)} {}

CanSocket& CanSocket::operator=(CanSocket&& other) noexcept {
  if (this != &other) {
    close();
    file_ = std::exchange(other.file_, -1);
  }
  return *this;
}

void CanSocket::close() noexcept {
  if (file_ >= 0) ::close(std::exchange(file_, -1));
}

int CanSocket::interface_index(const char* interface) const noexcept {
  ifreq request = request_for(interface);
  return ::ioctl(file_, SIOCGIFINDEX, &request) == 0 ? request.ifr_ifindex : 0;
}

bool CanSocket::interface_up(const char* interface) const noexcept {
  ifreq request = request_for(interface);
  return ::ioctl(file_, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

std::uint32_t CanSocket::drops(std::uint32_t otherwise) const noexcept {
  std::array<std::uint32_t, SK_MEMINFO_VARS> info{};
  socklen_t size = sizeof(info);
  const bool known = ::getsockopt(file_, SOL_SOCKET, SO_MEMINFO, info.data(), &size) == 0 &&
                     size > SK_MEMINFO_DROPS * sizeof(info[0]);
  return known ? info[SK_MEMINFO_DROPS] : otherwise;
}

SocketAttempt open_for_receiving(const char* interface, const ReceiveOptions& options) noexcept {
  SocketAttempt attempt = new_socket();
  if (attempt.failed == nullptr) attempt.failed = prepare_receiving(options, attempt);
  if (attempt.failed == nullptr) bind_to(interface, attempt);
  return closed_where_failed(std::move(attempt));
}

SocketAttempt open_for_sending(const char* interface) noexcept {
  SocketAttempt attempt = new_socket();
  if (attempt.failed == nullptr) attempt.failed = prepare_sending(attempt.socket.file());
  if (attempt.failed == nullptr) bind_to(interface, attempt);
  return closed_where_failed(std::move(attempt));
}

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

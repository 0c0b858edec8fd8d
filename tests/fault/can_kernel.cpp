// SPDX-License-Identifier: MIT
#include "tests/fault/can_kernel.hpp"

#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/net_tstamp.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

namespace dampline::fault {
namespace {

CanKernel* the_kernel = nullptr;

int fail(int error) {
  errno = error;
  return -1;
}

template <class T>
void put(msghdr& header, std::size_t& used, int type, const T& value) {
  const std::size_t space = CMSG_SPACE(sizeof(T));
  if (used + space > header.msg_controllen) {
    header.msg_flags |= MSG_CTRUNC;
    return;
  }
  cmsghdr at{};
  at.cmsg_level = SOL_SOCKET;
  at.cmsg_type = type;
  at.cmsg_len = CMSG_LEN(sizeof(T));
  auto* const place = static_cast<std::uint8_t*>(header.msg_control) + used;
  std::memcpy(place, &at, sizeof(at));
  std::memcpy(place + CMSG_LEN(0), &value, sizeof(T));
  used += space;
}

timespec to_timespec(std::int64_t time_ns) {
  return {time_ns / 1'000'000'000, time_ns % 1'000'000'000};
}

}  // namespace

CanKernel::CanKernel() { the_kernel = this; }
CanKernel::~CanKernel() { the_kernel = nullptr; }
CanKernel* CanKernel::current() noexcept { return the_kernel; }

void CanKernel::add(const std::string& interface, bool up) {
  interfaces_[interface] = {next_index_++, up};
}

void CanKernel::up(const std::string& interface) { interfaces_.at(interface).up = true; }

void CanKernel::down(const std::string& interface) {
  if (!interfaces_.at(interface).up) return;
  interfaces_.at(interface).up = false;
  tell(interfaces_.at(interface).index, ENETDOWN);
}

void CanKernel::remove(const std::string& interface) {
  const int index = interfaces_.at(interface).index;
  down(interface);
  tell(index, ENODEV);  // before anybody saw the ENETDOWN
  for (auto& [file, socket] : sockets_) {
    if (socket.index == index) socket.index = 0;
  }
  interfaces_.erase(interface);
}

void CanKernel::tell(int index, int error) {
  for (auto& [file, socket] : sockets_) {
    if (socket.index != index) continue;
    socket.error = error;
    signal(file, socket);
  }
}

void CanKernel::fail_sockets(int error) {
  for (auto& [file, socket] : sockets_) {
    socket.error = error;
    signal(file, socket);
  }
}

void CanKernel::signal(int file, const Socket& socket) const {
  eventfd_t count = 0;
  static_cast<void>(::eventfd_read(file, &count));
  if (socket.error != 0 || !socket.queue.empty()) static_cast<void>(::eventfd_write(file, 1));
}

const CanKernel::Interface* CanKernel::by_index(int index) const {
  const auto found = std::find_if(interfaces_.begin(), interfaces_.end(),
                                  [&](const auto& entry) { return entry.second.index == index; });
  return found == interfaces_.end() ? nullptr : &found->second;
}

int CanKernel::flag(const Socket& socket, int level, int name) {
  const auto found = socket.options.find({level, name});
  int value = 0;
  if (found != socket.options.end()) {
    std::memcpy(&value, found->second.data(), std::min(sizeof(value), found->second.size()));
  }
  return value;
}

bool CanKernel::wants(const Socket& socket, const canfd_frame& frame) {
  if ((frame.can_id & CAN_ERR_FLAG) != 0) {
    return (flag(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER) & static_cast<int>(frame.can_id) &
            static_cast<int>(CAN_ERR_MASK)) != 0;
  }
  const auto found = socket.options.find({SOL_CAN_RAW, CAN_RAW_FILTER});
  if (found == socket.options.end()) return true;
  for (std::size_t at = 0; at + sizeof(can_filter) <= found->second.size();
       at += sizeof(can_filter)) {
    can_filter filter{};
    std::memcpy(&filter, &found->second[at], sizeof(filter));
    if ((frame.can_id & filter.can_mask) == (filter.can_id & filter.can_mask)) return true;
  }
  return false;
}

void CanKernel::receive(const canfd_frame& frame, std::size_t bytes, const KernelStamps& stamps) {
  for (auto& [file, socket] : sockets_) {
    const Interface* const interface = by_index(socket.index);
    if (interface == nullptr || !interface->up || !wants(socket, frame)) continue;
    if (bytes == CANFD_MTU && flag(socket, SOL_CAN_RAW, CAN_RAW_FD_FRAMES) == 0) continue;
    if (socket.queue.size() >= room_) {
      ++socket.drops;
      continue;
    }
    socket.queue.push_back({frame, bytes, stamps, socket.drops});
    signal(file, socket);
  }
}

void CanKernel::receive(std::uint32_t can_id, std::uint8_t first_byte, std::int64_t software_ns) {
  canfd_frame frame{};
  frame.can_id = can_id;
  frame.len = 8;
  frame.data[0] = first_byte;
  receive(frame, CAN_MTU, {software_ns, 0});
}

std::vector<std::uint8_t> CanKernel::option(int level, int name) const {
  const auto found = last_options_.find({level, name});
  return found == last_options_.end() ? std::vector<std::uint8_t>{} : found->second;
}

int CanKernel::open_socket() {
  const int file = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  sockets_[file] = {};
  calls_.emplace_back("socket");
  ++opened_;
  return file;
}

int CanKernel::set_option(int file, int level, int name, const void* value, socklen_t size) {
  calls_.push_back("setsockopt " + std::to_string(level) + " " + std::to_string(name));
  if (unknown_.contains({level, name})) return fail(ENOPROTOOPT);
  const auto* const bytes = static_cast<const std::uint8_t*>(value);
  const std::vector<std::uint8_t> content{bytes, bytes + size};
  sockets_.at(file).options[{level, name}] = content;
  last_options_[{level, name}] = content;
  return 0;
}

int CanKernel::get_option(int file, int level, int name, void* value, socklen_t* size) {
  if (level != SOL_SOCKET) return fail(ENOPROTOOPT);
  if (name == SO_MEMINFO) {
    std::array<std::uint32_t, SK_MEMINFO_VARS> info{};
    info[SK_MEMINFO_DROPS] = sockets_.at(file).drops;
    std::memcpy(value, info.data(), std::min<std::size_t>(*size, sizeof(info)));
    *size = std::min<socklen_t>(*size, sizeof(info));
    return 0;
  }
  const Socket& socket = sockets_.at(file);
  const int forced = flag(socket, SOL_SOCKET, SO_RCVBUFFORCE);
  const int granted = 2 * (forced != 0 ? forced : flag(socket, SOL_SOCKET, SO_RCVBUF));
  std::memcpy(value, &granted, sizeof(granted));
  return 0;
}

int CanKernel::bind_socket(int file, const sockaddr_can& address) {
  calls_.emplace_back("bind");
  const Interface* const interface = by_index(address.can_ifindex);
  if (interface == nullptr) return fail(ENODEV);
  Socket& socket = sockets_.at(file);
  socket.index = address.can_ifindex;
  if (!interface->up) socket.error = ENETDOWN;
  signal(file, socket);
  return 0;
}

int CanKernel::find_interface(const char* name, int request, void* answer) {
  const auto found = interfaces_.find(name);
  if (found == interfaces_.end()) return fail(ENODEV);
  auto& reply = *static_cast<ifreq*>(answer);
  if (request == SIOCGIFINDEX) {
    reply.ifr_ifindex = found->second.index;
  } else {
    reply.ifr_flags = static_cast<short>(found->second.up ? IFF_UP : 0);
  }
  return 0;
}

void CanKernel::put_controls(const Socket& socket, const Queued& queued, msghdr& header) {
  std::size_t used = 0;
  const int stamping = flag(socket, SOL_SOCKET, SO_TIMESTAMPING);
  if (stamping != 0) {
    scm_timestamping stamps{};
    stamps.ts[0] = to_timespec(queued.stamps.software_ns);
    if ((stamping & SOF_TIMESTAMPING_RAW_HARDWARE) != 0) {
      stamps.ts[2] = to_timespec(queued.stamps.hardware_ns);
    }
    put(header, used, SO_TIMESTAMPING, stamps);
  } else if (flag(socket, SOL_SOCKET, SO_TIMESTAMPNS) != 0) {
    put(header, used, SO_TIMESTAMPNS, to_timespec(queued.stamps.software_ns));
  } else if (flag(socket, SOL_SOCKET, SO_TIMESTAMP) != 0) {
    const std::int64_t micro = queued.stamps.software_ns / 1000;
    put(header, used, SO_TIMESTAMP, timeval{micro / 1'000'000, micro % 1'000'000});
  }
  if (flag(socket, SOL_SOCKET, SO_RXQ_OVFL) != 0 && queued.drops != 0) {
    put(header, used, SO_RXQ_OVFL, queued.drops);
  }
  header.msg_controllen = used;
}

int CanKernel::receive_messages(int file, mmsghdr* messages, unsigned count) {
  Socket& socket = sockets_.at(file);
  if (socket.error != 0) {
    const int error = std::exchange(socket.error, 0);
    signal(file, socket);
    return fail(error);
  }
  unsigned done = 0;
  for (; done < count && !socket.queue.empty(); ++done) {
    const Queued& queued = socket.queue.front();
    msghdr& header = messages[done].msg_hdr;
    const std::size_t bytes = std::min(header.msg_iov->iov_len, queued.bytes);
    std::memcpy(header.msg_iov->iov_base, &queued.frame, std::min(bytes, sizeof(canfd_frame)));
    header.msg_flags = queued.bytes > bytes ? MSG_TRUNC : 0;
    messages[done].msg_len = static_cast<unsigned>(bytes);
    put_controls(socket, queued, header);
    socket.queue.pop_front();
  }
  signal(file, socket);
  return done > 0 ? static_cast<int>(done) : fail(EAGAIN);
}

int CanKernel::send_messages(int file, const mmsghdr* messages, unsigned count) {
  Socket& socket = sockets_.at(file);
  if (socket.error != 0) return fail(std::exchange(socket.error, 0));
  const Interface* const interface = by_index(socket.index);
  if (interface == nullptr) return fail(ENXIO);
  if (!interface->up) return fail(ENETDOWN);
  unsigned done = 0;
  for (; done < count && transmit_room_ > 0; ++done) {
    const msghdr& header = messages[done].msg_hdr;
    const bool fd = header.msg_iov->iov_len == CANFD_MTU;
    if (fd && flag(socket, SOL_CAN_RAW, CAN_RAW_FD_FRAMES) == 0) {
      return done > 0 ? static_cast<int>(done) : fail(EINVAL);
    }
    canfd_frame frame{};
    std::memcpy(&frame, header.msg_iov->iov_base, header.msg_iov->iov_len);
    sent_.push_back(frame);
    if (transmit_room_ != static_cast<std::size_t>(-1)) --transmit_room_;
  }
  return done > 0 ? static_cast<int>(done) : fail(ENOBUFS);
}

}  // namespace dampline::fault

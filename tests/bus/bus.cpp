// SPDX-License-Identifier: MIT
#include "tests/bus/bus.hpp"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "tests/bus/child.hpp"

namespace dampline::bus {
namespace {

constexpr std::size_t kBatch = 64;

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error{errno, std::generic_category(), what};
}

canfd_frame wire_of(const CanFrame& frame) {
  canfd_frame wire{};
  wire.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) |
                (frame.remote ? CAN_RTR_FLAG : 0U) | (frame.error ? CAN_ERR_FLAG : 0U);
  wire.len = frame.length;
  std::copy(frame.data.begin(), frame.data.end(), std::begin(wire.data));
  return wire;
}

std::size_t size_of(const CanFrame& frame) { return frame.fd ? CANFD_MTU : CAN_MTU; }

}  // namespace

VirtualCan::VirtualCan() {
  for (int number = 0; name_.empty() || ::if_nametoindex(name_.c_str()) != 0; ++number)
    name_ = "vcan" + std::to_string(number);
  create();
}

VirtualCan::~VirtualCan() {
  try {
    if (exists_) remove();
  } catch (const std::exception&) {  // a test may have removed it by other means
  }
}

void VirtualCan::create() {
  run({"ip", "link", "add", "dev", name_, "type", "vcan"});
  exists_ = true;
  run({"ip", "link", "set", name_, "mtu", std::to_string(CANFD_MTU)});
  up();
}

void VirtualCan::remove() {
  exists_ = false;
  run({"ip", "link", "del", name_});
}

void VirtualCan::up() const { run({"ip", "link", "set", name_, "up"}); }
void VirtualCan::down() const { run({"ip", "link", "set", name_, "down"}); }

std::uint64_t VirtualCan::carried() const {
  return std::stoull(read_file("/sys/class/net/" + name_ + "/statistics/tx_packets"));
}

RawSender::RawSender(const std::string& interface) : interface_{interface} { open(); }

RawSender::~RawSender() { ::close(socket_); }

void RawSender::open() {
  socket_ = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
  if (socket_ < 0) fail("socket");
  const int on = 1;
  ::setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on);
  ::setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0);  // it only sends
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(interface_.c_str()));
  if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    fail("bind to " + interface_);
}

void RawSender::bind_again() {
  ::close(socket_);
  open();
}

bool RawSender::send(const CanFrame& frame) { return send(std::span{&frame, 1}) == 1; }

std::size_t RawSender::send(std::span<const CanFrame> frames) {
  std::array<canfd_frame, kBatch> wires{};
  std::array<iovec, kBatch> parts{};
  std::array<mmsghdr, kBatch> messages{};
  std::size_t done = 0;
  while (done < frames.size()) {
    const std::size_t count = std::min(kBatch, frames.size() - done);
    for (std::size_t i = 0; i < count; ++i) {
      wires[i] = wire_of(frames[done + i]);
      parts[i] = {&wires[i], size_of(frames[done + i])};
      messages[i].msg_hdr.msg_iov = &parts[i];
      messages[i].msg_hdr.msg_iovlen = 1;
    }
    const int taken = ::sendmmsg(socket_, messages.data(), static_cast<unsigned>(count), 0);
    if (taken <= 0) break;
    done += static_cast<std::size_t>(taken);
  }
  sent_ += done;
  return done;
}

}  // namespace dampline::bus

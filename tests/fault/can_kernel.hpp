// SPDX-License-Identifier: MIT
// A model of the kernel's CAN stack behind the program's own system calls (socket_calls.cpp): what
// raw sockets do in net/can/raw.c as far as a driver can see it.
#pragma once
#include <linux/can.h>
#include <poll.h>
#include <sys/socket.h>

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

namespace dampline::fault {

/// The stamps that the kernel would put on a frame, by the wall clock and by the controller.
struct KernelStamps {
  std::int64_t software_ns{0};
  std::int64_t hardware_ns{0};
};

/// While one is alive, CAN sockets are its own. A socket's descriptor is an eventfd that is
/// readable when the socket is, so that polls are real.
class CanKernel {
 public:
  CanKernel();
  ~CanKernel();
  CanKernel(const CanKernel&) = delete;
  CanKernel& operator=(const CanKernel&) = delete;
  [[nodiscard]] static CanKernel* current() noexcept;

  // The test's side.
  void add(const std::string& interface, bool up = true);
  void remove(const std::string& interface);
  void up(const std::string& interface);
  void down(const std::string& interface);
  /// A frame comes in; `bytes` other than a frame's are for tests of the driver's own checks.
  void receive(const canfd_frame& frame, std::size_t bytes, const KernelStamps& stamps);
  void receive(std::uint32_t can_id, std::uint8_t first_byte, std::int64_t software_ns);
  /// An error that the next call on every socket reports.
  void fail_sockets(int error);
  void set_room(std::size_t frames) noexcept { room_ = frames; }
  /// Options that this kernel does not know.
  void forget_option(int level, int name) { unknown_[{level, name}] = true; }
  [[nodiscard]] const std::vector<std::string>& calls() const noexcept { return calls_; }
  [[nodiscard]] const std::vector<canfd_frame>& sent() const noexcept { return sent_; }
  /// The transmit queue takes so many frames more, then it is full (ENOBUFS) until drained.
  void set_transmit_room(std::size_t frames) noexcept { transmit_room_ = frames; }
  /// As it was set last on any socket.
  [[nodiscard]] std::vector<std::uint8_t> option(int level, int name) const;
  [[nodiscard]] std::size_t sockets_opened() const noexcept { return opened_; }
  [[nodiscard]] std::size_t sockets_open() const noexcept { return sockets_.size(); }

  // The driver's side.
  [[nodiscard]] bool owns(int file) const { return sockets_.contains(file); }
  int open_socket();
  int set_option(int file, int level, int name, const void* value, socklen_t size);
  int get_option(int file, int level, int name, void* value, socklen_t* size);
  int bind_socket(int file, const sockaddr_can& address);
  int find_interface(const char* name, int request, void* answer);
  int receive_messages(int file, mmsghdr* messages, unsigned count);
  int send_messages(int file, const mmsghdr* messages, unsigned count);
  void forget(int file) { sockets_.erase(file); }

 private:
  struct Interface {
    int index{0};
    bool up{false};
  };
  struct Queued {
    canfd_frame frame{};
    std::size_t bytes{0};
    KernelStamps stamps{};
    std::uint32_t drops{0};
  };
  struct Socket {
    int index{0};
    int error{0};
    std::uint32_t drops{0};
    std::deque<Queued> queue{};
    std::map<std::pair<int, int>, std::vector<std::uint8_t>> options{};
  };
  [[nodiscard]] const Interface* by_index(int index) const;
  [[nodiscard]] static bool wants(const Socket& socket, const canfd_frame& frame);
  static int flag(const Socket& socket, int level, int name);
  static void put_controls(const Socket& socket, const Queued& queued, msghdr& header);
  void signal(int file, const Socket& socket) const;
  void tell(int index, int error);

  std::map<std::string, Interface> interfaces_;
  std::map<int, Socket> sockets_;
  std::map<std::pair<int, int>, std::vector<std::uint8_t>> last_options_;
  std::map<std::pair<int, int>, bool> unknown_;
  std::vector<std::string> calls_;
  std::vector<canfd_frame> sent_;
  std::size_t room_{1000};
  std::size_t transmit_room_{static_cast<std::size_t>(-1)};
  std::size_t opened_{0};
  int next_index_{3};
};

}  // namespace dampline::fault

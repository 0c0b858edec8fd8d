// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "dampline/can_frame.hpp"

namespace dampline::bus {

/// A vcan interface of the test's own, up; goes away with it.
class VirtualCan {
 public:
  /// Takes a free name. Throws std::runtime_error with the text of ip(8).
  VirtualCan();
  VirtualCan(const VirtualCan&) = delete;
  VirtualCan& operator=(const VirtualCan&) = delete;
  ~VirtualCan();
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  void down() const;
  void up() const;
  /// The interface itself.
  void remove();
  /// After remove(): again, under the same name, up.
  void create();
  /// Frames that the kernel has carried over it.
  [[nodiscard]] std::uint64_t carried() const;

 private:
  std::string name_;
  bool exists_{false};
};

/// A raw CAN socket that sends, written independently of the driver under test.
class RawSender {
 public:
  /// Throws std::system_error.
  explicit RawSender(const std::string& interface);
  RawSender(const RawSender&) = delete;
  RawSender& operator=(const RawSender&) = delete;
  ~RawSender();
  /// False when the kernel refused it: the link is down or away. Sends what the fields say: flags
  /// of error, remote and extended frames, CAN FD.
  bool send(const CanFrame& frame);
  /// In few system calls; how many the kernel took.
  std::size_t send(std::span<const CanFrame> frames);
  /// After the interface came back with another number.
  void bind_again();
  [[nodiscard]] std::uint64_t sent() const noexcept { return sent_; }

 private:
  void open();
  std::string interface_;
  int socket_{-1};
  std::uint64_t sent_{0};
};

}  // namespace dampline::bus

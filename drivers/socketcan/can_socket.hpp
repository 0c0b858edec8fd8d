// SPDX-License-Identifier: MIT
#pragma once
#include <linux/can.h>

#include <cstdint>
#include <span>

namespace dampline::drivers {

/// Owns a raw CAN socket.
class CanSocket {
 public:
  CanSocket() = default;
  explicit CanSocket(int file) noexcept : file_{file} {}
  CanSocket(CanSocket&& other) noexcept;
  CanSocket& operator=(CanSocket&& other) noexcept;
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;
  ~CanSocket() { close(); }
  void close() noexcept;
  [[nodiscard]] int file() const noexcept { return file_; }
  [[nodiscard]] bool is_open() const noexcept { return file_ >= 0; }

  /// By name, now; 0: there is none. Names are cut at 15 bytes.
  [[nodiscard]] int interface_index(const char* interface) const noexcept;
  [[nodiscard]] bool interface_up(const char* interface) const noexcept;
  /// Frames that the kernel dropped so far because the queue was full; `otherwise` where the kernel
  /// does not say.
  [[nodiscard]] std::uint32_t drops(std::uint32_t otherwise) const noexcept;

 private:
  int file_{-1};
};

/// What opening came to, without allocating: it is tried again and again while an interface is
/// away.
struct SocketAttempt {
  CanSocket socket{};
  int interface_index{0};
  int receive_buffer_bytes{0};  ///< as the kernel granted it
  const char* failed{nullptr};  ///< which step; null: none
  int error_number{0};
};

struct ReceiveOptions {
  std::span<const can_filter> filters{};  ///< none, or too many for the kernel: every frame
  int receive_buffer_bytes{0};
  bool hardware_times{true};
};

/// A socket that does not block, bound to the interface, which may be down.
[[nodiscard]] SocketAttempt open_for_receiving(const char* interface,
                                               const ReceiveOptions& options) noexcept;
/// The same for sending; it receives nothing.
[[nodiscard]] SocketAttempt open_for_sending(const char* interface) noexcept;

}  // namespace dampline::drivers

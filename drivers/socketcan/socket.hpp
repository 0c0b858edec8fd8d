// SPDX-License-Identifier: MIT
#pragma once
#include <linux/can.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// Whose frames are wanted.
struct Identifier {
  std::uint32_t id{0};
  bool extended{false};  ///< 29 bits
};

/// The kernel takes no more filters than this (CAN_RAW_FILTER_MAX).
inline constexpr std::size_t kMostFilters = 512;

/// Filters that let exactly the data frames of these identifiers through: the mask holds the flags
/// too, so that neither a remote request nor the other frame format of the same number passes.
/// Sorted, each once.
[[nodiscard]] std::vector<can_filter> make_filters(std::span<const Identifier> identifiers);

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

/// How often a missing interface is looked for.
inline constexpr std::int64_t kLookEveryNs = 200'000'000;

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

/// Why a socket could not be opened: what was tried, what the kernel said, which interfaces there
/// are.
[[nodiscard]] Failure open_failure(const std::string& interface, const SocketAttempt& attempt);

}  // namespace dampline::drivers

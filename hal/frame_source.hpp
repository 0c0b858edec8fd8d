// SPDX-License-Identifier: MIT
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dampline/result.hpp"
#include "dampline/sample/can_frame.hpp"

namespace dampline::hal {

/// Monotone counters; a source never resets them.
struct SourceHealth {
  std::uint64_t frames{0};     ///< delivered
  std::uint64_t dropped{0};    ///< known to be lost before they could be read
  std::uint64_t malformed{0};  ///< input that was not a frame, skipped on request
  std::uint64_t ignored{0};    ///< well-formed input that is no frame (comments, other text)
  std::uint64_t reordered{0};  ///< arrived with an earlier time than the one before; time was held
  bool truncated{false};       ///< the input ended in the middle of a frame
};

/// Where CAN frames come from: a bus, a log file, the simulated sensors.
/// Contract, run by tests/contract over every implementation:
///  - read() never blocks; 0 frames is success, not an error
///  - frames arrive in non-decreasing time_ns
///  - after kEndOfStream every later read() is kEndOfStream
///  - after kLinkDown a later read() may succeed again; the source reconnects by itself
class FrameSource {
 public:
  FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;
  virtual ~FrameSource() = default;
  [[nodiscard]] Result<std::size_t> read(std::span<CanFrame> out) noexcept { return do_read(out); }
  /// True when read() will deliver or report something; false after `timeout`.
  [[nodiscard]] Result<bool> wait(std::chrono::nanoseconds timeout) noexcept {
    return do_wait(timeout);
  }
  [[nodiscard]] SourceHealth health() const noexcept { return do_health(); }

 private:
  virtual Result<std::size_t> do_read(std::span<CanFrame> out) noexcept = 0;
  virtual Result<bool> do_wait(std::chrono::nanoseconds timeout) noexcept = 0;
  [[nodiscard]] virtual SourceHealth do_health() const noexcept = 0;
};

}  // namespace dampline::hal

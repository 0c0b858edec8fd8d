// SPDX-License-Identifier: MIT
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "dampline/can_frame.hpp"
#include "dampline/result.hpp"
#include "hal/event.hpp"

namespace dampline::hal {

/// Monotone counters; a source never resets them.
struct SourceHealth {
  std::uint64_t frames{0};     ///< delivered
  std::uint64_t dropped{0};    ///< known to be lost before they could be read
  std::uint64_t malformed{0};  ///< input that was not a frame, skipped on request
  std::uint64_t ignored{0};    ///< well-formed input that is no frame (comments, other text)
  std::uint64_t reordered{0};  ///< arrived with an earlier time than the one before; time was held
  bool truncated{false};       ///< the input ended in the middle of a frame
  // Of a bus; a file has none of these.
  std::uint64_t error_frames{0};    ///< delivered, and among `frames`
  std::uint64_t hardware_times{0};  ///< frames stamped by the controller; the others by the kernel
  std::uint64_t link_downs{0};      ///< the interface went down, or away
  std::uint64_t reopened{0};        ///< a new socket, because the interface had been removed
  std::uint64_t bus_offs{0};        ///< the controller left the bus
  std::uint64_t restarts{0};        ///< and came back
  std::uint64_t clock_steps{0};     ///< the wall clock jumped; frame times did not
  bool link_up{true};
};

/// Where CAN frames come from: a bus, a log file, the simulated sensors.
/// Contract, run over every implementation (tests/contract/frame_source_contract.hpp):
///  - read() never blocks; 0 frames is success, not an error
///  - frames arrive in non-decreasing time_ns
///  - after kEndOfStream every later read() is kEndOfStream
///  - after kLinkDown a later read() may succeed again; the source reconnects by itself
///  - events come in the order of their time; between two reads, those of the frames just read
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
  /// Takes the oldest event that was not taken yet; false when there is none.
  [[nodiscard]] bool next_event(Event& out) noexcept { return do_next_event(out); }
  /// Now, by the clock that stamps the frames; absent for a record.
  [[nodiscard]] std::optional<std::int64_t> now_ns() const noexcept { return do_now_ns(); }

 private:
  virtual Result<std::size_t> do_read(std::span<CanFrame> out) noexcept = 0;
  virtual Result<bool> do_wait(std::chrono::nanoseconds timeout) noexcept = 0;
  [[nodiscard]] virtual SourceHealth do_health() const noexcept = 0;
  [[nodiscard]] virtual bool do_next_event(Event& /*out*/) noexcept { return false; }
  [[nodiscard]] virtual std::optional<std::int64_t> do_now_ns() const noexcept { return {}; }
};

}  // namespace dampline::hal

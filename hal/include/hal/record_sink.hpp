// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "dampline/can_frame.hpp"
#include "hal/event.hpp"

namespace dampline::hal {

/// Monotone counters, but for `recording`.
struct RecordHealth {
  std::uint64_t frames{0};         ///< written
  std::uint64_t events{0};         ///< written
  std::uint64_t lost{0};           ///< frames and events that could not be written
  std::uint64_t bytes{0};          ///< written, headers included
  std::uint64_t files{0};          ///< begun
  std::uint64_t files_removed{0};  ///< by the retention limit
  std::uint64_t syncs{0};
  std::uint64_t failed_syncs{0};  ///< each was the end of its file
  std::int32_t last_errno{0};
  bool recording{true};  ///< false: the disk is full or failed; tried again from time to time
};

/// Where frames and events are kept. Calls may block on a disk: they belong on a thread of their
/// own. No call fails: what could not be kept is counted in health().
class RecordSink {
 public:
  RecordSink() = default;
  RecordSink(const RecordSink&) = delete;
  RecordSink& operator=(const RecordSink&) = delete;
  virtual ~RecordSink() = default;
  void write(const CanFrame& frame) noexcept { do_write(frame); }
  void write(const Event& event) noexcept { do_write(event); }
  /// Call some times a second: writes out, syncs, rotates and tries again when these are due.
  void tick(std::int64_t monotonic_ns) noexcept { do_tick(monotonic_ns); }
  /// Ends the current file; the next record begins a new one.
  void rotate() noexcept { do_rotate(); }
  /// Everything so far is on the disk when this returns, or health() says that it is not.
  void close() noexcept { do_close(); }
  [[nodiscard]] RecordHealth health() const noexcept { return do_health(); }

 private:
  virtual void do_write(const CanFrame& frame) noexcept = 0;
  virtual void do_write(const Event& event) noexcept = 0;
  virtual void do_tick(std::int64_t monotonic_ns) noexcept = 0;
  virtual void do_rotate() noexcept = 0;
  virtual void do_close() noexcept = 0;
  [[nodiscard]] virtual RecordHealth do_health() const noexcept = 0;
};

}  // namespace dampline::hal

// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "dampline/sample/reading.hpp"
#include "dampline/sample/tick_line.hpp"

namespace dampline {

/// Ticks from time alone, for channels without a counter. A frame is never early but may be late,
/// and the ones behind it then catch up. So a frame that seems to leave a gap is held until a later
/// one decides: caught up means late, still behind after kHeld frames means lost.
class TimeSequence {
 public:
  static constexpr std::size_t kHeld = 4;

  explicit TimeSequence(double rate_hz) noexcept : line_{rate_hz, kPeriodRange} {}
  void start(std::int64_t tick, std::int64_t time_ns) noexcept;
  /// Takes one reading; false when it repeats the one before. Then pop() until it is empty.
  /// Precondition: started, and popped empty.
  bool push(const Reading& reading) noexcept;
  /// Readings with their tick set, in order.
  [[nodiscard]] std::optional<Reading> pop() noexcept;
  /// End of the stream: what is held is numbered by its time.
  void flush() noexcept;
  [[nodiscard]] const TickLine& line() const noexcept { return line_; }
  [[nodiscard]] std::int64_t newest() const noexcept { return newest_; }

 private:
  static constexpr double kPeriodRange = 0.1;
  void release(bool in_sequence) noexcept;

  TickLine line_;
  std::int64_t newest_{0};
  std::array<Reading, kHeld> held_{};
  std::size_t held_count_{0};
  std::size_t released_{0};  // the first so many of held_ have their tick
};

}  // namespace dampline

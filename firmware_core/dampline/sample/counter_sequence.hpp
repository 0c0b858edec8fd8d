// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>

#include "dampline/sample/tick_line.hpp"

namespace dampline {

/// Where a frame stands in its channel's sequence.
enum class Place : std::uint8_t {
  kNext,       ///< a new sample
  kBehind,     ///< out of order or repeated: its tick is not after the newest
  kOutOfStep,  ///< counter and time contradict each other; not used
  kRealigned,  ///< a new sample, and the tick was set by time: the node restarted its counter
};
struct Placement {
  Place place{Place::kOutOfStep};
  std::int64_t tick{0};
  int streak{0};  ///< frames in a row, this one included, that continue each other only
};

/// Ticks from a counter of any length. The counter decides; the time resolves how often it wrapped.
/// A frame whose counter does not fit its time is not used; four of them in a row that agree with
/// each other are a restarted node, whose tick is then set by time.
class CounterSequence {
 public:
  /// counter_bits 1...64.
  CounterSequence(unsigned counter_bits, double rate_hz) noexcept;
  void start(std::int64_t tick, std::uint64_t counter, std::int64_t time_ns) noexcept;
  /// Precondition: started.
  Placement place(std::uint64_t counter, std::int64_t time_ns) noexcept;
  /// The usual case, where place() would say kNext with a streak of 0: takes the frame, whose tick
  /// is then newest(). False, and nothing done: place() has to decide.
  bool place_next(std::uint64_t counter, std::int64_t time_ns) noexcept;
  [[nodiscard]] const TickLine& line() const noexcept { return line_; }
  [[nodiscard]] std::int64_t newest() const noexcept { return line_.tick(); }

 private:
  // Frames delivered in a burst may be this late and still be numbered by their counter.
  static constexpr double kBurstTicks = 32.0;
  [[nodiscard]] std::int64_t resolve(std::uint64_t counter, double due_tick) const noexcept;
  [[nodiscard]] bool fits(std::int64_t tick, double due_tick) const noexcept;
  [[nodiscard]] bool continues_streak(std::uint64_t counter) const noexcept;
  Placement suspect(std::int64_t tick, std::uint64_t counter, std::int64_t time_ns) noexcept;
  Placement accept(Place place, std::int64_t tick, std::uint64_t counter,
                   std::int64_t time_ns) noexcept;

  TickLine line_;
  std::uint64_t mask_;
  double wrap_;       // 2^bits
  double tolerance_;  // ticks; wider for long counters, where a chance agreement is unlikely
  double usual_;      // ticks; a next counter this near is the next sample whatever else holds
  std::uint64_t newest_counter_{0};
  int streak_{0};  // consecutive frames that continue each other but not the sequence
  std::uint64_t streak_counter_{0};
  std::int64_t streak_tick_{0};
  double streak_error_{0.0};
};

inline bool CounterSequence::place_next(std::uint64_t counter, std::int64_t time_ns) noexcept {
  if (((counter - newest_counter_) & mask_) != 1 || streak_ != 0 || !line_.step(time_ns, usual_))
    return false;
  newest_counter_ = counter;
  return true;
}

}  // namespace dampline

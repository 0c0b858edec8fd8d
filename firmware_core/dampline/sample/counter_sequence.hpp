// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>
#include <utility>

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
  [[nodiscard]] const TickLine& line() const noexcept { return line_; }
  [[nodiscard]] std::int64_t newest() const noexcept { return newest_; }

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
  std::int64_t newest_{0};
  std::uint64_t newest_counter_{0};
  int streak_{0};  // consecutive frames that continue each other but not the sequence
  std::uint64_t streak_counter_{0};
  std::int64_t streak_tick_{0};
  double streak_error_{0.0};
};

inline std::int64_t CounterSequence::resolve(std::uint64_t counter,
                                             double due_tick) const noexcept {
  const std::uint64_t ahead = (counter - newest_counter_) & mask_;
  const double due_ahead = due_tick - static_cast<double>(newest_);
  if (ahead == 1 && std::abs(due_ahead - 1.0) < 0.49 * wrap_) return newest_ + 1;  // the usual one
  const double wraps = std::nearbyint((due_ahead - static_cast<double>(ahead)) / wrap_);
  // Modulo 2^64 on purpose: a counter of 64 bits that goes back one wraps to a step of -1.
  const std::uint64_t step =
      ahead + (mask_ + 1) * static_cast<std::uint64_t>(static_cast<std::int64_t>(wraps));
  return newest_ + static_cast<std::int64_t>(step);
}

inline bool CounterSequence::fits(std::int64_t tick, double due_tick) const noexcept {
  const double off = std::abs(due_tick - static_cast<double>(tick));
  if (tick == newest_ + 1) return off <= kBurstTicks;
  return tick > newest_ && off <= tolerance_;
}

inline Placement CounterSequence::accept(Place place, std::int64_t tick, std::uint64_t counter,
                                         std::int64_t time_ns) noexcept {
  line_.update(tick, time_ns);
  newest_ = tick;
  newest_counter_ = counter;
  return {place, tick, std::exchange(streak_, 0)};
}

inline Placement CounterSequence::place(std::uint64_t counter, std::int64_t time_ns) noexcept {
  const double due_tick = line_.tick_at(time_ns);
  const std::int64_t tick = resolve(counter, due_tick);
  if (fits(tick, due_tick)) return accept(Place::kNext, tick, counter, time_ns);
  return suspect(tick, counter, time_ns);
}

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace dampline {

/// Straight line of time over tick that follows a channel: predicts at which tick a frame is due.
/// A g-h filter with the gains of a growing least-squares line (Kalata; Benedict and Bordner),
/// which stop shrinking at a memory's frames. A single frame moves the line by half a tick at most.
class TickLine {
 public:
  /// The period stays within [1 - period_range, 1 / (1 - period_range)] of the nominal one.
  /// `memory`: frames.
  TickLine(double rate_hz, double period_range, double memory = kMemory) noexcept
      : memory_{memory},
        period_ns_{1e9 / rate_hz},
        shortest_ns_{period_ns_ * (1.0 - period_range)},
        longest_ns_{period_ns_ / (1.0 - period_range)} {}

  void start(std::int64_t tick, std::int64_t time_ns) noexcept {
    tick_ = tick;
    time_ns_ = time_ns;
    phase_ns_ = 0.0;
  }

  /// The tick, with fraction, that the line has at a time.
  [[nodiscard]] double tick_at(std::int64_t time_ns) const noexcept {
    return static_cast<double>(tick_) +
           (static_cast<double>(time_ns - time_ns_) - phase_ns_) / period_ns_;
  }

  /// Precondition: tick is larger than that of the update before.
  void update(std::int64_t tick, std::int64_t time_ns) noexcept {
    const auto steps = static_cast<double>(tick - tick_);
    const double predicted_ns = phase_ns_ + steps * period_ns_;
    const double off_ns = static_cast<double>(time_ns - time_ns_) - predicted_ns;
    const double error_ns = limited(off_ns);
    if (frames_ < memory_) set_gains(frames_ + 1.0);
    correct(predicted_ns + phase_gain_ * error_ns, period_gain_ * error_ns / steps);
    tick_ = tick;
  }

  /// Whether the time is within `ticks` of that tick's.
  [[nodiscard]] bool is_near(std::int64_t tick, std::int64_t time_ns, double ticks) const noexcept {
    const double predicted_ns = phase_ns_ + static_cast<double>(tick - tick_) * period_ns_;
    return std::abs(static_cast<double>(time_ns - time_ns_) - predicted_ns) < ticks * period_ns_;
  }

  [[nodiscard]] std::int64_t tick() const noexcept { return tick_; }
  [[nodiscard]] std::int64_t time_ns() const noexcept { return time_ns_; }

 private:
  [[nodiscard]] double limited(double off_ns) const noexcept {
    const double half_ns = 0.5 * period_ns_;
    return std::clamp(off_ns, -half_ns, half_ns);
  }
  /// `phase_ns` is positive: a step is a period at least, and the error half of one at most.
  void correct(double phase_ns, double period_off_ns) noexcept {
    period_ns_ = std::clamp(period_ns_ + period_off_ns, shortest_ns_, longest_ns_);
    const auto whole_ns = static_cast<std::int64_t>(phase_ns);
    time_ns_ += whole_ns;
    phase_ns_ = phase_ns - static_cast<double>(whole_ns);
  }
  void set_gains(double frames) noexcept {
    frames_ = frames;
    phase_gain_ = 2.0 * (2.0 * frames - 1.0) / (frames * (frames + 1.0));
    period_gain_ = 6.0 / (frames * (frames + 1.0));
  }

  static constexpr double kMemory = 128.0;
  static constexpr double kPrior = 16.0;  // the nominal period counts as so many frames
  double memory_;
  std::int64_t tick_{0};
  std::int64_t time_ns_{0};
  double phase_ns_{0.0};  // below one nanosecond; keeps what time_ns_ cannot
  double frames_{kPrior};
  double phase_gain_{0.0};
  double period_gain_{0.0};
  double period_ns_;
  double shortest_ns_;
  double longest_ns_;
};

/// One channel's value in one frame.
struct Reading {
  std::int64_t tick{0};
  std::int64_t time_ns{0};
  double accel_mps2{0.0};
  bool saturated{false};
};

/// Where a frame stands in its channel's sequence.
enum class Place : std::uint8_t {
  kNext,       ///< a new sample
  kBehind,     ///< out of order or repeated: its tick is not after the newest
  kOutOfStep,  ///< counter and time contradict each other; not used
  kRealigned,  ///< a new sample, and the tick was set by time: the node restarted its counter
  kLostTrack,  ///< not used, nor what follows until the sequence is started anew
};
struct Placement {
  Place place{Place::kOutOfStep};
  std::int64_t tick{0};
  int streak{0};  ///< frames in a row, this one included, that continue each other only
};

/// Ticks from a counter of any length. The counter decides; the time resolves how often it wrapped.
/// A frame whose counter does not fit its time is not used; four of them in a row that agree with
/// each other are a restarted node, whose tick is then set by time. Where frames come in bursts
/// time is too coarse for that: track is lost, and the channels have to be aligned anew. The line
/// goes through the last frame of each burst, which is in time.
class CounterSequence {
 public:
  /// Frames delivered in a burst may be this late and still be numbered by their counter.
  static constexpr double kBurstTicks = 48.0;

  /// counter_bits 1...64.
  CounterSequence(unsigned counter_bits, double rate_hz) noexcept;
  void start(std::int64_t tick, std::uint64_t counter, std::int64_t time_ns) noexcept;
  /// Precondition: started.
  Placement place(std::uint64_t counter, std::int64_t time_ns) noexcept;
  /// The usual case, where place() would say kNext with a streak of 0: takes the frame, whose tick
  /// is then newest(). False, and nothing done: place() has to decide.
  bool place_next(std::uint64_t counter, std::int64_t time_ns) noexcept;
  [[nodiscard]] const TickLine& line() const noexcept { return line_; }
  [[nodiscard]] std::int64_t newest() const noexcept { return newest_; }
  /// A burst ended and the next one went on from it, so that no frame is missing at its end. A
  /// frame on its own is a burst.
  [[nodiscard]] bool has_whole_end() const noexcept { return has_whole_end_; }
  /// Frames of late came many at once: a time tells the tick no better than to a burst's length.
  [[nodiscard]] bool is_bursty() const noexcept {
    return far_frames_ >= kBurstFrames && newest() - far_tick_ <= kBurstPause;
  }

 private:
  static constexpr int kBurstFrames = 4;
  static constexpr std::uint64_t kCaughtUp = 8;  // ticks; a counter further on is another node's
  static constexpr std::int64_t kBurstPause = 96;
  void note_far(std::int64_t tick) noexcept;
  /// A frame came, `ahead` of the one before, which was the last of its burst unless this one
  /// catches up with it.
  void settle(std::int64_t time_ns, std::uint64_t ahead) noexcept {
    const auto ticks = static_cast<std::int64_t>(std::clamp(ahead, std::uint64_t{1}, kCaughtUp));
    if (time_ns - newest_ns_ < ticks * catching_up_ns_) return;
    is_first_ = false;
    has_whole_end_ |= ahead == 1;
    if (newest_ > line_.tick()) line_.update(newest_, newest_ns_);
  }
  void take(std::int64_t tick, std::uint64_t counter, std::int64_t time_ns) noexcept {
    if (is_first_) {
      line_.start(tick, time_ns);
      note_far(tick);
    }
    newest_ = tick;
    newest_ns_ = time_ns;
    newest_counter_ = counter;
  }
  [[nodiscard]] std::int64_t resolve(std::uint64_t ahead, double due_tick) const noexcept;
  [[nodiscard]] bool fits(std::int64_t tick, double due_tick) const noexcept;
  /// A loss within a burst: `off` ticks from the line, of which `tick` is not many behind the
  /// newest.
  [[nodiscard]] bool fits_in_burst(std::int64_t tick, double off) const noexcept;
  [[nodiscard]] bool continues_streak(std::uint64_t counter) const noexcept;
  Placement suspect(std::int64_t tick, std::uint64_t counter, std::int64_t time_ns) noexcept;
  Placement accept(Place place, std::int64_t tick, std::uint64_t counter,
                   std::int64_t time_ns) noexcept;

  TickLine line_;
  std::uint64_t mask_;
  double wrap_;       // 2^bits
  double tolerance_;  // ticks; wider for long counters, where a chance agreement is unlikely
  double usual_;      // ticks; a next counter this near is the next sample whatever else holds
  std::int64_t catching_up_ns_;  // frames that follow each other within it are of one burst
  bool is_first_{true};          // of the burst of the start
  bool has_whole_end_{false};
  std::int64_t newest_{0};
  std::int64_t newest_ns_{0};
  std::uint64_t newest_counter_{0};
  int streak_{0};  // consecutive frames that continue each other but not the sequence
  std::uint64_t streak_counter_{0};
  std::int64_t streak_tick_{0};
  double streak_error_{0.0};
  int far_frames_{0};  // next ones, far off the line, without a long stretch of others between
  std::int64_t far_tick_{0};
};

inline bool CounterSequence::place_next(std::uint64_t counter, std::int64_t time_ns) noexcept {
  if (((counter - newest_counter_) & mask_) != 1 || streak_ != 0) return false;
  settle(time_ns, 1);
  if (!line_.is_near(newest_ + 1, time_ns, usual_)) return false;
  take(newest_ + 1, counter, time_ns);
  return true;
}

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

struct MeasuredRate {
  double rate_hz{0.0};  ///< 0: fewer than three samples
  double std_hz{0.0};   ///< for errors of the times that are independent of each other
  std::uint64_t samples{0};
};

/// Sample rate from the samples' own times: the slope of a straight line through time over tick, by
/// least squares in one pass. Deviations from the nominal line are summed, not the times, so that a
/// day of samples loses no digits. Every segment has its own intercept, all have the slope in
/// common.
class RateMeter {
 public:
  explicit constexpr RateMeter(double nominal_rate_hz) noexcept
      : nominal_period_ns_{1e9 / nominal_rate_hz} {}
  void update(std::int64_t tick, std::int64_t time_ns) noexcept;
  /// The next sample begins a segment: how its ticks continue those before is not known exactly.
  void begin_segment() noexcept;
  [[nodiscard]] MeasuredRate measured() const noexcept;

 private:
  double nominal_period_ns_;
  std::int64_t first_tick_{0};
  std::int64_t first_time_ns_{0};
  double count_{0.0};  // of the segment; means are of the segment as well
  double mean_ticks_{0.0};
  double mean_deviation_ns_{0.0};
  double sum_tt_{0.0};  // centred sums over all segments: ticks squared,
  double sum_td_{0.0};  // ticks times deviation,
  double sum_dd_{0.0};  // deviation squared
  std::uint64_t samples_{0};
  std::uint64_t segments_{0};
};

inline void RateMeter::update(std::int64_t tick, std::int64_t time_ns) noexcept {
  if (count_ == 0.0) {
    first_tick_ = tick;
    first_time_ns_ = time_ns;
    mean_ticks_ = mean_deviation_ns_ = 0.0;
    ++segments_;
  }
  const auto ticks = static_cast<double>(tick - first_tick_);
  const double deviation_ns =
      static_cast<double>(time_ns - first_time_ns_) - ticks * nominal_period_ns_;
  // Welford, "Note on a method for calculating corrected sums of squares and products", 1962.
  count_ += 1.0;
  ++samples_;
  const double ticks_off = ticks - mean_ticks_;
  const double deviation_off = deviation_ns - mean_deviation_ns_;
  mean_ticks_ += ticks_off / count_;
  mean_deviation_ns_ += deviation_off / count_;
  sum_tt_ += ticks_off * (ticks - mean_ticks_);
  sum_td_ += ticks_off * (deviation_ns - mean_deviation_ns_);
  sum_dd_ += deviation_off * (deviation_ns - mean_deviation_ns_);
}

}  // namespace dampline

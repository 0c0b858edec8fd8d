// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dampline {

/// Straight line of time over tick that follows a channel: predicts at which tick a frame is due.
/// A g-h filter with the gains of a growing least-squares line (Kalata; Benedict and Bordner),
/// which stop shrinking at kMemory frames. A single frame moves the line by half a tick at most.
class TickLine {
 public:
  /// The period stays within [1 - period_range, 1 / (1 - period_range)] of the nominal one.
  TickLine(double rate_hz, double period_range) noexcept
      : period_ns_{1e9 / rate_hz},
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

  /// False where tick_at(time_ns) is more than `ticks` after the tick of the latest update. May be
  /// false a little before.
  [[nodiscard]] bool is_near(std::int64_t time_ns, double ticks) const noexcept {
    return static_cast<double>(time_ns - time_ns_) < ticks * shortest_ns_;
  }

  /// Precondition: tick is larger than that of the update before.
  void update(std::int64_t tick, std::int64_t time_ns) noexcept {
    const auto steps = static_cast<double>(tick - tick_);
    const double predicted_ns = phase_ns_ + steps * period_ns_;
    const double off_ns = static_cast<double>(time_ns - time_ns_) - predicted_ns;
    const double error_ns = limited(off_ns);
    if (frames_ < kMemory) set_gains(frames_ + 1.0);
    correct(predicted_ns + phase_gain_ * error_ns, period_gain_ * error_ns / steps);
    tick_ = tick;
  }

  /// As update(tick() + 1, time_ns) where the time is within `ticks` of that tick's; else false,
  /// and nothing is done.
  [[nodiscard]] bool step(std::int64_t time_ns, double ticks) noexcept {
    const double predicted_ns = phase_ns_ + period_ns_;
    const double off_ns = static_cast<double>(time_ns - time_ns_) - predicted_ns;
    if (!(std::abs(off_ns) < ticks * period_ns_)) return false;
    const double error_ns = limited(off_ns);
    if (frames_ < kMemory) set_gains(frames_ + 1.0);
    correct(predicted_ns + phase_gain_ * error_ns, period_gain_ * error_ns);
    ++tick_;
    return true;
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

}  // namespace dampline

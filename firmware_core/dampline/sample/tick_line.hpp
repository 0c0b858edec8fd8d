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
    const double half_ns = 0.5 * period_ns_;
    const double error_ns =
        std::clamp(static_cast<double>(time_ns - time_ns_) - predicted_ns, -half_ns, half_ns);
    if (frames_ < kMemory) set_gains(frames_ + 1.0);
    phase_ns_ = predicted_ns + phase_gain_ * error_ns;
    period_ns_ =
        std::clamp(period_ns_ + period_gain_ * error_ns / steps, shortest_ns_, longest_ns_);
    tick_ = tick;
    const double whole_ns = std::floor(phase_ns_);
    time_ns_ += static_cast<std::int64_t>(whole_ns);
    phase_ns_ -= whole_ns;
  }

  [[nodiscard]] std::int64_t time_ns() const noexcept { return time_ns_; }

 private:
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

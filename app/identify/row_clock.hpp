// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>
#include <optional>

#include "dampline/sample/ticks.hpp"

namespace dampline::app {

/// Sample numbers of rows that carry only a time: each row gets the tick at which the line through
/// the rows before it expects its time, so that rounding and jitter of the times do not make gaps.
/// A tick that is jumped over is a lost row.
class RowClock {
 public:
  /// `rate_hz` is the record's own, from its first rows.
  explicit RowClock(double rate_hz)
      : rate_hz_{rate_hz}, line_{rate_hz, kPeriodRange}, meter_{rate_hz} {}

  struct Stamp {
    std::int64_t tick{0};
    std::int64_t time_ns{0};  ///< from the first row
  };
  /// Precondition: times increase.
  Stamp next(double time_s) {
    if (!first_time_s_) {
      first_time_s_ = time_s;
      line_.start(0, 0);
      meter_.update(0, 0);
      return {};
    }
    const auto time_ns = static_cast<std::int64_t>(std::llround(1e9 * (time_s - *first_time_s_)));
    const auto due = static_cast<std::int64_t>(std::llround(line_.tick_at(time_ns)));
    const std::int64_t tick = std::max(due, tick_ + 1);
    if (static_cast<double>(tick - tick_) > kLongGapSeconds * rate_hz_) meter_.begin_segment();
    line_.update(tick, time_ns);
    meter_.update(tick, time_ns);
    tick_ = tick;
    return {tick, time_ns};
  }
  [[nodiscard]] MeasuredRate rate() const { return meter_.measured(); }

 private:
  static constexpr double kPeriodRange = 0.02;
  static constexpr double kLongGapSeconds =
      3.0;  // over which the line does not know the tick exactly
  double rate_hz_;
  TickLine line_;
  RateMeter meter_;
  std::optional<double> first_time_s_;
  std::int64_t tick_{0};
};

}  // namespace dampline::app

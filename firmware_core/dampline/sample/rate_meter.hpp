// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

namespace dampline {

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

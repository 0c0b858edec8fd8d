// SPDX-License-Identifier: MIT
#include "dampline/sample/rate_meter.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {

void RateMeter::begin_segment() noexcept { count_ = 0.0; }

void RateMeter::update(std::int64_t tick, std::int64_t time_ns) noexcept {
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

MeasuredRate RateMeter::measured() const noexcept {
  MeasuredRate result{0.0, 0.0, samples_};
  const double freedom = static_cast<double>(samples_) - static_cast<double>(segments_) - 1.0;
  if (!(freedom > 0.0) || !(sum_tt_ > 0.0)) return result;
  const double slope_ns = sum_td_ / sum_tt_;
  const double period_ns = nominal_period_ns_ + slope_ns;
  if (!(period_ns > 0.0)) return result;
  const double residual_ns2 = std::max(sum_dd_ - slope_ns * sum_td_, 0.0) / freedom;
  result.rate_hz = 1e9 / period_ns;
  result.std_hz = result.rate_hz * std::sqrt(residual_ns2 / sum_tt_) / period_ns;
  return result;
}

}  // namespace dampline

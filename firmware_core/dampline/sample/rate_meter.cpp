// SPDX-License-Identifier: MIT
#include "dampline/sample/rate_meter.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {

void RateMeter::begin_segment() noexcept { count_ = 0.0; }

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

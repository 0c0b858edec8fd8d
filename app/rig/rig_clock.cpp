// SPDX-License-Identifier: MIT
#include "app/rig/rig_clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/error.hpp"

namespace dampline::app {
namespace {

constexpr std::size_t kFirstRows = 2000;
constexpr std::size_t kFewestRows = 100;
constexpr double kLongestGapSamples = 1e12;

}  // namespace

std::int64_t RigClock::advance(const RigLine& line) {
  if (!started_) {
    started_ = true;
    first_s_ = line.time_s;
    last_s_ = line.time_s;
    first_timed_tick_ = tick_ + 1;
    return last_timed_tick_ = first_timed_tick_;
  }
  const double samples = (line.time_s - last_s_) / interval_s_;
  if (!(samples > 0.0) || samples > kLongestGapSamples)
    throw RunError{
        fmt::format("{}:{}: time_s: found {:.9g} s after {:.9g} s, expected time to advance",
                    record_, line.line, line.time_s, last_s_)};
  const double whole = std::max(1.0, std::round(samples));
  if (std::abs(samples - whole) > kIrregularSamples) {
    ++irregular_;
    if (irregular_ == 1) {
      irregular_line_ = line.line;
      irregular_s_ = line.time_s - last_s_;
    }
  }
  last_s_ = line.time_s;
  return last_timed_tick_ += static_cast<std::int64_t>(whole);
}

RigSample RigClock::sample(const RigLine& line) {
  ++rows_;
  RigSample out{0, line.deflection_m, line.velocity_mps, line.force_n};
  if (std::isfinite(line.time_s)) {
    tick_ = std::max(advance(line), tick_);
  } else {
    ++tick_;
    out.deflection_m = std::numeric_limits<double>::quiet_NaN();
  }
  out.tick = tick_;
  return out;
}

void RigClock::check_uniform() const {
  if (static_cast<double>(irregular_) <= kIrregularShare * static_cast<double>(rows_)) return;
  throw RunError{fmt::format(
      "{}: time_s: {} of {} intervals are irregular, the first at line {} with {:.6g} s; expected "
      "whole multiples of {:.6g} s (resample the record at a uniform rate)",
      record_, irregular_, rows_, irregular_line_, irregular_s_, interval_s_)};
}

double RigClock::mean_interval_s() const noexcept {
  const auto intervals = static_cast<double>(last_timed_tick_ - first_timed_tick_);
  return intervals > 0.0 ? (last_s_ - first_s_) / intervals : interval_s_;
}

double measure_interval_s(const RigRecord& record) {
  const auto source = record.open();
  std::vector<double> intervals;
  double last_s = std::numeric_limits<double>::quiet_NaN();
  RigLine line;
  std::size_t rows = 0;
  for (; rows < kFirstRows && source->next(line); ++rows) {
    const double interval_s = line.time_s - last_s;
    if (interval_s > 0.0) intervals.push_back(interval_s);
    if (std::isfinite(line.time_s)) last_s = line.time_s;
  }
  if (intervals.size() < kFewestRows)
    throw RunError{fmt::format("{}: found {} rows whose time advances, expected at least {}",
                               record.name, intervals.size(), kFewestRows)};
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

}  // namespace dampline::app

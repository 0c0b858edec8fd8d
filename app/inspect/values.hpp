// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace dampline::app {

/// What a signal or a column holds, in its own unit. Values that are no numbers are passed over.
class Values {
 public:
  void take(double x) noexcept {
    if (!std::isfinite(x)) return;
    ++count_;
    const double from_mean = x - mean_;  // Welford
    mean_ += from_mean / static_cast<double>(count_);
    squares_ += from_mean * (x - mean_);
    least_ = std::min(least_, x);
    most_ = std::max(most_, x);
    if (count_ > 1 && x != last_) step_ = std::min(step_, std::fabs(x - last_));
    last_ = x;
  }
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] double mean() const noexcept { return mean_; }
  /// About the mean.
  [[nodiscard]] double rms() const noexcept {
    return count_ == 0 ? 0.0 : std::sqrt(squares_ / static_cast<double>(count_));
  }
  /// Precondition of both: count() > 0.
  [[nodiscard]] double least() const noexcept { return least_; }
  [[nodiscard]] double most() const noexcept { return most_; }
  [[nodiscard]] bool moves() const noexcept { return count_ > 1 && least_ < most_; }
  /// The smallest step between neighbours. Precondition: moves().
  [[nodiscard]] double step() const noexcept { return step_; }

 private:
  std::uint64_t count_{0};
  double mean_{0.0};
  double squares_{0.0};
  double least_{std::numeric_limits<double>::infinity()};
  double most_{-std::numeric_limits<double>::infinity()};
  double step_{std::numeric_limits<double>::infinity()};
  double last_{0.0};
};

}  // namespace dampline::app

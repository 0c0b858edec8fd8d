// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>

namespace dampline {

/// The resolution of a channel for which none is declared: the least change between two samples. A
/// moving channel changes by one code within seconds.
class StepMeter {
 public:
  /// Of one sample of the channel.
  void update(double value) noexcept {
    const double change = std::abs(value - last_);
    last_ = value;
    if (!any_) {
      any_ = true;
    } else if (change > kSame) {
      least_ = least_ > 0.0 ? std::min(least_, change) : change;
    }
  }
  /// In the channel's unit; 0: it never changed.
  [[nodiscard]] double step() const noexcept { return least_; }

 private:
  static constexpr double kSame = 1e-9;  // rounding of a value that was printed
  bool any_{false};
  double last_{0.0};
  double least_{0.0};
};

}  // namespace dampline

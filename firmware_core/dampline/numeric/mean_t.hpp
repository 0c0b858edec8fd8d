// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>

namespace dampline {

/// Student's t of a mean: by how many of its own standard deviations it differs from 0, judged by
/// the scatter of the values, which are added one by one.
class MeanT {
 public:
  void add(double value) noexcept {
    sum_ += value;
    squares_ += value * value;
    count_ += 1.0;
  }
  [[nodiscard]] double count() const noexcept { return count_; }
  /// 0 where they do not scatter, and of fewer than two.
  [[nodiscard]] double t() const noexcept {
    const double variance = (squares_ - sum_ * sum_ / count_) / (count_ - 1.0);
    return variance > 0.0 ? sum_ / std::sqrt(count_ * variance) : 0.0;
  }

 private:
  double sum_{0.0};
  double squares_{0.0};
  double count_{0.0};
};

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace dampline {

/// Mean and scatter of repeated estimates, in one pass (Welford 1962).
template <int Unknowns>
class EstimateScatter {
 public:
  using Vector = Eigen::Matrix<double, Unknowns, 1>;

  void add(const Vector& theta) noexcept {
    ++count_;
    const Vector from_old = theta - mean_;
    mean_ += from_old / static_cast<double>(count_);
    sum_squares_ += from_old.cwiseProduct(theta - mean_);
  }

  [[nodiscard]] std::int64_t count() const noexcept { return count_; }
  [[nodiscard]] const Vector& mean() const noexcept { return mean_; }
  /// Sample standard deviation, with count - 1 below the sum; 0 for one estimate.
  [[nodiscard]] Vector deviation() const noexcept {
    if (count_ < 2) return Vector::Zero();
    return (sum_squares_ / static_cast<double>(count_ - 1)).cwiseSqrt();
  }
  /// Coefficient of variation: deviation / |mean|.
  [[nodiscard]] Vector cov() const noexcept { return deviation().cwiseQuotient(mean_.cwiseAbs()); }

 private:
  Vector mean_ = Vector::Zero();
  Vector sum_squares_ = Vector::Zero();
  std::int64_t count_{0};
};

}  // namespace dampline

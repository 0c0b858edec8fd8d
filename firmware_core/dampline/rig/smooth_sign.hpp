// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <numbers>

namespace dampline {

/// sign(v) as expected from a velocity with a Gaussian error: erf(0.8862 v / w), of slope 1 / w at
/// v = 0, averaged exactly over the straight line between samples. Without the average the jump at
/// a reversal falls on whole samples and biases the friction level.
class SmoothSign {
 public:
  explicit SmoothSign(double width_mps) noexcept : width_mps_{width_mps} {}

  /// Mean over the stretch from half a sample before to half a sample after `v`.
  [[nodiscard]] double mean(double v_before, double v, double v_after) const noexcept {
    return 0.5 * (line_mean(0.5 * (v_before + v), v) + line_mean(v, 0.5 * (v + v_after)));
  }

 private:
  static constexpr double kSlope = 0.8862269254527580;  // sqrt(pi) / 2

  [[nodiscard]] double line_mean(double a, double b) const noexcept {
    const double far = 6.0 * width_mps_;
    if (a > far && b > far) return 1.0;
    if (a < -far && b < -far) return -1.0;
    if (std::abs(b - a) < 1e-3 * width_mps_) return std::erf(kSlope * 0.5 * (a + b) / width_mps_);
    return (integral(b) - integral(a)) / (b - a);
  }

  [[nodiscard]] double integral(double v) const noexcept {
    const double z = kSlope * v / width_mps_;
    return v * std::erf(z) + width_mps_ / kSlope * std::numbers::inv_sqrtpi * std::exp(-z * z);
  }

  double width_mps_;
};

}  // namespace dampline

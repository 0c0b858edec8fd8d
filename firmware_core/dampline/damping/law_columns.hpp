// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "dampline/damping/smooth_sign.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

inline constexpr std::size_t kLawWidths = 10;

/// The widths w of the friction law that are tried side by side, in m/s.
inline constexpr std::array<double, kLawWidths> kLawWidthMps{
    0.5e-3, 0.7e-3, 1.0e-3, 1.4e-3, 2.0e-3, 2.8e-3, 4.0e-3, 5.6e-3, 8.0e-3, 11.0e-3};

/// Everything of the damping force that is not linear in the accelerations, as regressors over the
/// relative velocity: smooth signs of each width, and the ramps of an odd broken line.
class LawColumns {
 public:
  static constexpr int kCount = static_cast<int>(kLawWidths + kCurveSegments);
  using Values = Eigen::Matrix<double, kCount, 1>;

  /// `nodes_mps`: right ends of the segments, increasing. The last segment goes on without end.
  explicit LawColumns(const std::array<double, kCurveSegments>& nodes_mps) noexcept {
    double left = 0.0;
    for (std::size_t i = 0; i < kCurveSegments; ++i) {
      left_mps_[i] = left;
      length_mps_[i] = i + 1 < kCurveSegments ? nodes_mps[i] - left : 1e3;
      left = nodes_mps[i];
    }
    for (std::size_t i = 0; i < kLawWidths; ++i) slope_[i] = kSignSlope / kLawWidthMps[i];
  }

  /// Rows 0...9: erf(0.8862 v / w_i), no unit; rows 10...17: ramp_i(|v|) sign v, m/s.
  [[nodiscard]] Values operator()(double velocity_mps) const noexcept {
    Values out;
    const double speed = std::abs(velocity_mps);
    const double sign = std::copysign(1.0, velocity_mps);
    for (std::size_t i = 0; i < kLawWidths; ++i) {
      out[static_cast<int>(i)] = sign * erf_of_magnitude(slope_[i] * speed);
    }
    for (std::size_t i = 0; i < kCurveSegments; ++i) {
      out[static_cast<int>(kLawWidths + i)] =
          sign * std::min(std::max(speed - left_mps_[i], 0.0), length_mps_[i]);
    }
    return out;
  }

 private:
  std::array<double, kLawWidths> slope_{};
  std::array<double, kCurveSegments> left_mps_{};
  std::array<double, kCurveSegments> length_mps_{};
};

}  // namespace dampline

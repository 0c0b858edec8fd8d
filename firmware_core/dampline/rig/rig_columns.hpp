// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "dampline/numeric/information.hpp"
#include "dampline/rig/rig_config.hpp"
#include "dampline/rig/rig_motion.hpp"
#include "dampline/rig/smooth_sign.hpp"

namespace dampline {

/// Columns of the equations: every model is made of sums of these.
namespace rig_column {
inline constexpr int kInertia = 0;    ///< x''
inline constexpr int kStiffness = 1;  ///< x
inline constexpr int kViscous = 2;    ///< x'
inline constexpr int kSign = 3;       ///< smooth sign of v
inline constexpr int kOne = 4;
inline constexpr int kRampPositive = 5;  ///< 8 segments of v > 0, ascending; slope +1 in v
inline constexpr int kRampNegative = kRampPositive + static_cast<int>(kCurveSegments);
inline constexpr int kForce = kRampNegative + static_cast<int>(kCurveSegments);
inline constexpr int kCount = kForce + 1;
}  // namespace rig_column

using RigInformation = Information<rig_column::kCount>;

/// Part of a speed that lies in each segment; the last segment has no end. Sums to `speed`.
[[nodiscard]] inline std::array<double, kCurveSegments> ramps(
    double speed, const std::array<double, kCurveSegments>& nodes) noexcept {
  std::array<double, kCurveSegments> out{};
  double start = 0.0;
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    const bool last = i + 1 == kCurveSegments;
    const double end = last || speed < nodes[i] ? speed : nodes[i];
    out[i] = end > start ? end - start : 0.0;
    start = nodes[i];
  }
  return out;
}

/// The columns that are functions of the velocity, at one instant. The others are left at 0.
class RigRegressors {
 public:
  explicit RigRegressors(const RigConfig& config) noexcept
      : sign_{config.sign_width_mps}, nodes_{config.curve_nodes_mps} {}

  void fill(const RigMotion& motion, RigInformation::Row& row) const noexcept {
    row[rig_column::kSign] =
        sign_.mean(motion.velocity_before_mps, motion.velocity_mps, motion.velocity_after_mps);
    row[rig_column::kOne] = 1.0;
    const bool positive = motion.velocity_mps > 0.0;
    const double speed = positive ? motion.velocity_mps : -motion.velocity_mps;
    const auto parts = ramps(speed, nodes_);
    const int first = positive ? rig_column::kRampPositive : rig_column::kRampNegative;
    for (std::size_t i = 0; i < kCurveSegments; ++i)
      row[first + static_cast<int>(i)] = positive ? parts[i] : -parts[i];
  }

 private:
  SmoothSign sign_;
  std::array<double, kCurveSegments> nodes_;
};

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

#include "dampline/basis/smooth_sign.hpp"
#include "dampline/numeric/information.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

/// Right ends of the segments of the damping curve, increasing, m/s; the last segment goes on
/// without end.
using CurveNodes = std::array<double, kCurveSegments>;
/// Fixed in advance, so that statistics of different runs have the same basis and merge.
inline constexpr CurveNodes kDefaultCurveNodesMps{3.0e-3,  5.5e-3,  8.0e-3,  11.0e-3,
                                                  14.5e-3, 19.0e-3, 26.0e-3, 40.0e-3};

inline constexpr std::size_t kLawWidths = 10;

/// The widths w of the friction law that are tried side by side, in m/s.
inline constexpr std::array<double, kLawWidths> kLawWidthMps{
    0.5e-3, 0.7e-3, 1.0e-3, 1.4e-3, 2.0e-3, 2.8e-3, 4.0e-3, 5.6e-3, 8.0e-3, 11.0e-3};

/// Everything of the damping force that is not linear in the accelerations, as regressors over the
/// relative velocity: smooth signs of each width, and the ramps of an odd broken line.
///
/// Calculated in single precision, four columns by one instruction: 1e-6 of a sign and 1e-7 of a
/// velocity are a thousandth of what the sensors' noise leaves of them.
class LawColumns {
 public:
  static constexpr int kCount = static_cast<int>(kLawWidths + kCurveSegments);
  using Values = Eigen::Matrix<double, kCount, 1>;

  static constexpr int kSignLanes = 12;  ///< the signs, filled up to whole vectors of four
  static constexpr int kLanes = kSignLanes + static_cast<int>(kCurveSegments);
  static_assert(kSignLanes >= static_cast<int>(kLawWidths) && kLanes % 4 == 0);
  /// The columns as they are stored; what lies between signs and ramps is zero, or a frame's turn.
  using Lanes = Eigen::Array<float, kLanes, 1>;

  explicit LawColumns(const CurveNodes& nodes_mps) noexcept {
    double left = 0.0;
    for (std::size_t i = 0; i < kCurveSegments; ++i) {
      const double length = i + 1 < kCurveSegments ? nodes_mps[i] - left : 1e3;
      left_mps_[i] = static_cast<float>(left);
      length_mps_[i] = static_cast<float>(length);
      left = nodes_mps[i];
    }
    for (std::size_t i = 0; i < kLawWidths; ++i)
      slope_[i] = static_cast<float>(kSignSlope / kLawWidthMps[i]);
  }

  /// Lanes 0...9: erf(0.8862 v / w_i), no unit; lanes 12...19: ramp_i(|v|) sign v, m/s.
  [[nodiscard]] Lanes lanes(double velocity_mps) const noexcept {
    Lanes out;
    lanes_to(out.data(), velocity_mps);
    return out;
  }
  /// The same to kLanes numbers from `out` on. Plain loops, so that compilers make vectors of them
  /// as wide as the processor has.
  void lanes_to(float* __restrict out, double velocity_mps) const noexcept {
    const auto velocity = static_cast<float>(velocity_mps);
    const float speed = std::abs(velocity);
    const float sign = std::copysign(1.0F, velocity);
    for (std::size_t i = 0; i < kSigns; ++i) out[i] = sign * erf_of_magnitude(slope_[i] * speed);
    for (std::size_t i = 0; i < kRamps; ++i) {
      const float beyond = speed - left_mps_[i];
      const float ramp = beyond > 0.0F ? beyond : 0.0F;
      out[kSigns + i] = sign * (ramp < length_mps_[i] ? ramp : length_mps_[i]);
    }
  }

  /// Rows 0...9: the signs; rows 10...17: the ramps.
  [[nodiscard]] static Values values(const Lanes& lanes) noexcept {
    Values out;
    out.head<static_cast<int>(kLawWidths)>() =
        lanes.head<static_cast<int>(kLawWidths)>().matrix().cast<double>();
    constexpr auto kTail = static_cast<int>(kRamps);
    out.tail<kTail>() = lanes.tail<kTail>().matrix().cast<double>();
    return out;
  }
  [[nodiscard]] Values operator()(double velocity_mps) const noexcept {
    return values(lanes(velocity_mps));
  }

 private:
  static constexpr auto kSigns = static_cast<std::size_t>(kSignLanes);
  static constexpr std::size_t kRamps = kCurveSegments;
  std::array<float, kSigns> slope_{};
  std::array<float, kRamps> left_mps_{};
  std::array<float, kRamps> length_mps_{};
};

/// The columns of a Galerkin row, per unit of moving mass:
///   t = (k/M) X_k + (c/M) X_c + sum_i (F_i/M) X_i,   t = -<psi, z_b''>
/// First the law's columns (LawColumns), then these:
inline constexpr int kStiffnessColumn = LawColumns::kCount;
inline constexpr int kViscousColumn = kStiffnessColumn + 1;
inline constexpr int kTargetColumn = kViscousColumn + 1;
inline constexpr int kRowColumns = kTargetColumn + 1;

/// Lanes between signs and ramps that a frame's known turn adds to stiffness and target (Turn).
inline constexpr int kTurnSpringLane = static_cast<int>(kLawWidths);
inline constexpr int kTurnPushLane = kTurnSpringLane + 1;
static_assert(kTurnPushLane < LawColumns::kSignLanes);

using RowFactor = Information<kRowColumns>;
using GalerkinRow = RowFactor::Row;

}  // namespace dampline

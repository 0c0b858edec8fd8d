// SPDX-License-Identifier: MIT
#pragma once
#include "dampline/estimate/law_profile.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

/// An odd broken line over |v| with a jump at zero, per unit of moving mass:
///   F(v) / M = sign(v) [jump g(v / w*) + sum_i slope_i ramp_i(|v|)].
struct CurveFit {
  static constexpr int kJump = 0;
  static constexpr int kStiffness = 1;
  static constexpr int kFirstSlope = 2;
  static constexpr int kUnknowns = kFirstSlope + static_cast<int>(kCurveSegments);
  WeightedFit<kUnknowns> fit;
  WeightedFit<kUnknowns>::Square covariance = WeightedFit<kUnknowns>::Square::Zero();

  /// The law's width is taken from `law`, the broken line is fitted beside the spring.
  template <class Entries>
  static CurveFit make(const ScaleFactors& total, Entries entries, const LawProfile<true>& law,
                       const ScaleMask& mask, const CurveNodes& nodes_mps) noexcept;

  /// Force per unit of mass at a positive velocity, and its standard deviation: the jump counts
  /// whole there, since the width is mostly an error of the velocity.
  [[nodiscard]] Estimate force(double velocity_mps, const CurveNodes& nodes_mps) const noexcept;
};

}  // namespace dampline

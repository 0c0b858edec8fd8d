// SPDX-License-Identifier: MIT
#include "dampline/damping/curve.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

/// Over one segment the force is expected to change by no more than this share of the level; where
/// the data say otherwise they prevail, where a segment was hardly visited the curve stays flat.
constexpr double kExpectedChange = 0.07;

/// Length of a segment as a prior sees it: the last one goes on without end.
double length_mps(const CurveNodes& nodes_mps, std::size_t i) noexcept {
  return i == 0 ? nodes_mps[0] : nodes_mps[i] - nodes_mps[i - 1];
}

Information<CurveFit::kUnknowns + 1> flat_prior(double level,
                                                const CurveNodes& nodes_mps) noexcept {
  Information<CurveFit::kUnknowns + 1> prior;
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    Information<CurveFit::kUnknowns + 1>::Row row =
        Information<CurveFit::kUnknowns + 1>::Row::Zero();
    row[CurveFit::kFirstSlope + static_cast<int>(i)] =
        length_mps(nodes_mps, i) / (kExpectedChange * level);
    prior.absorb(row);
  }
  return prior;
}

}  // namespace

template <class Entries>
CurveFit CurveFit::make(const ScaleFactors& total, Entries entries, const LawProfile<true>& law,
                        const ScaleMask& mask, const CurveNodes& nodes_mps) noexcept {
  using Model = LawModel<true>;
  ColumnMap<kUnknowns> map = ColumnMap<kUnknowns>::Zero();
  const auto at = [](std::size_t i) { return static_cast<int>(i); };
  // The law at its continuous width: the jump's column is g_i + shift (g_(i+1) - g_(i-1)).
  map(at(law.width_index), kJump) += 1.0;
  map(at(Model::above(law.width_index)), kJump) += law.shift();
  map(at(Model::below(law.width_index)), kJump) -= law.shift();
  map(kStiffnessColumn, kStiffness) = 1.0;
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    map(at(kLawWidths + i), kFirstSlope + at(i)) = 1.0;
  }
  map(kTargetColumn, kUnknowns) = 1.0;
  CurveFit out;
  const double level = law.fit.theta[Model::kCoulomb];
  const auto prior = flat_prior(level, nodes_mps);
  out.fit = weighted_fit<kUnknowns>(total, map, mask, prior);
  if (out.fit.ok) out.covariance = score_covariance<kUnknowns>(out.fit, entries, map, prior);
  return out;
}
template CurveFit CurveFit::make(const ScaleFactors&, EntryList, const LawProfile<true>&,
                                 const ScaleMask&, const CurveNodes&) noexcept;
template CurveFit CurveFit::make(const ScaleFactors&, GroupedList, const LawProfile<true>&,
                                 const ScaleMask&, const CurveNodes&) noexcept;

Estimate CurveFit::force(double velocity_mps, const CurveNodes& nodes_mps) const noexcept {
  WeightedFit<kUnknowns>::Vector gradient = WeightedFit<kUnknowns>::Vector::Zero();
  gradient[kJump] = 1.0;
  double left_mps = 0.0;
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    const double length_mps = i + 1 < kCurveSegments ? nodes_mps[i] - left_mps : 1e3;
    gradient[kFirstSlope + static_cast<int>(i)] =
        std::clamp(velocity_mps - left_mps, 0.0, length_mps);
    left_mps = nodes_mps[i];
  }
  const double variance = gradient.dot(covariance.lazyProduct(gradient));
  return {gradient.dot(fit.theta), std::sqrt(std::max(variance, 0.0))};
}

}  // namespace dampline

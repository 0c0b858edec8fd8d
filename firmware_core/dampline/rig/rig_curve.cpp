// SPDX-License-Identifier: MIT
#include "dampline/rig/rig_curve.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

constexpr std::size_t kZeroPositive = kCurveSegments + 1;

/// Velocity of point i; the branch v < 0 comes first, outermost node first.
double velocity_of(std::size_t i, const RigConfig& config) noexcept {
  if (i < kCurveSegments) return -config.curve_nodes_mps[kCurveSegments - 1 - i];
  if (i <= kZeroPositive) return 0.0;
  return config.curve_nodes_mps[i - kZeroPositive - 1];
}

/// What unknown j adds to the force at a point, per unit: the regressors of one velocity.
SmallFactor::Vector weights_at(const RigModel& model, double velocity_mps, bool positive,
                               const RigConfig& config) noexcept {
  RigInformation::Row row = RigInformation::Row::Zero();
  const auto parts = ramps(std::abs(velocity_mps), config.curve_nodes_mps);
  row[rig_column::kSign] = positive ? 1.0 : -1.0;
  row[rig_column::kOne] = 1.0;
  const int first = positive ? rig_column::kRampPositive : rig_column::kRampNegative;
  for (std::size_t i = 0; i < kCurveSegments; ++i)
    row[first + static_cast<int>(i)] = positive ? parts[i] : -parts[i];
  SmallFactor::Vector out{};
  for (int j = 0; j < model.size(); ++j) out[static_cast<std::size_t>(j)] = model.value(j, row);
  return out;
}

}  // namespace

std::size_t nearest_rig_point(const RigConfig& config, double velocity_mps) noexcept {
  const auto& nodes = config.curve_nodes_mps;
  const double speed = std::abs(velocity_mps);
  std::size_t rank = 0;  // 0: v = 0
  double lower = 0.0;
  while (rank < kCurveSegments && speed > 0.5 * (lower + nodes[rank])) lower = nodes[rank++];
  return velocity_mps > 0.0 ? kZeroPositive + rank : kCurveSegments - rank;
}

RigCurve rig_curve(const RigSolution& solution, const RigConfig& config,
                   const std::array<std::uint64_t, kRigCurvePoints>& support) noexcept {
  RigCurve out;
  out.valid = solution.valid;
  if (!solution.valid) return out;
  for (std::size_t i = 0; i < kRigCurvePoints; ++i) {
    if (support[i] == 0) continue;
    const double velocity = velocity_of(i, config);
    const auto weights = weights_at(solution.model, velocity, i >= kZeroPositive, config);
    double force = 0.0;
    for (std::size_t j = 0; j < weights.size(); ++j) force += weights[j] * solution.theta[j];
    out.points[out.size++] = {velocity, force, solution.std_of(weights), support[i]};
  }
  return out;
}

}  // namespace dampline

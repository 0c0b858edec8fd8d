// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "dampline/density/fokker_planck_solver.hpp"

namespace dampline {

/// Velocities of the broken line's nodes and their hats' shares of the samples.
void FokkerPlanckSolver::place_points(const DriftSums& sums, MethodResult& result) const noexcept {
  const std::size_t segments = supported_segments(sums);
  const auto& nodes = data_.config_.curve_nodes_mps;
  result.points = 2 * (segments + 1);
  for (std::size_t s = 0; s < 2; ++s) {
    std::array<double, kCurveSegments + 2> held{};
    for (std::size_t b = 0; b < DriftBins::kPerSide; ++b) {
      const DriftMoments& m = sums.sides[s][b];
      const std::size_t left = std::min(b > 0 ? b - 1 : 0, segments);
      const double right_share = b == 0 ? 0.5 * m.u : (b == 1 ? 0.5 * (m.n + m.u) : m.u);
      const double right = b > segments ? m.n : std::min(right_share, m.n);
      held[std::min(left + 1, segments)] += right;
      held[left] += m.n - right;
    }
    for (std::size_t i = 0; i <= segments; ++i) {
      CurvePoint& point = result.curve[s == 1 ? segments + 1 + i : segments - i];
      point.velocity_mps = (s == 1 ? 1.0 : -1.0) * (i > 0 ? nodes[i - 1] : 0.0);
      point.samples = static_cast<std::uint64_t>(std::max(held[i], 0.0));
    }
  }
}

void FokkerPlanckSolver::place_paper_points(MethodResult& result) const noexcept {
  result.points = MethodResult::kMaxPoints;
  const double length = reach_mps_ / static_cast<double>(kPaperSegments);
  for (std::size_t i = 0; i <= kPaperSegments; ++i) {
    const double speed = static_cast<double>(i) * length;
    result.curve[kPaperSegments - i].velocity_mps = -speed;
    result.curve[kPaperSegments + 1 + i].velocity_mps = speed;
  }
  const auto& velocities = data_.velocities_;
  for (std::size_t b = 0; b < kVelocityBins; ++b) {
    const double v = velocities.axis().centre(b);
    const auto node =
        std::min(static_cast<std::size_t>(std::lround(std::abs(v) / length)), kPaperSegments);
    CurvePoint& point = result.curve[v > 0.0 ? kPaperSegments + 1 + node : kPaperSegments - node];
    point.samples += static_cast<std::uint64_t>(velocities.mass(b));
  }
}

}  // namespace dampline

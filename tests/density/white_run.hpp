// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <memory>

#include "dampline/density/fokker_planck.hpp"
#include "sim_hw/white_input.hpp"

namespace dampline {

inline constexpr double kMassKg = 37200.0;
inline constexpr double kStiffnessNpm = 5.26e6;
inline constexpr double kLevelN = 0.5 * (7562.0 + 9150.0);

inline std::unique_ptr<FokkerPlanck> white_run(const sim::WhiteInputConfig& white, double length_s,
                                               FokkerPlanckConfig config = {}) {
  auto out = std::make_unique<FokkerPlanck>(config);
  sim::WhiteInput source{white};
  const auto samples = static_cast<int>(length_s * sim::WhiteInput::sample_rate_hz());
  for (int i = 0; i < samples; ++i) out->update(source.next());
  return out;
}

/// Relative distance of a curve from F sign(v), |v| > 3 mm/s, root mean square over the samples.
inline double curve_error(const MethodResult& result, const VelocityHistogram& velocities,
                          double level_n = kLevelN) {
  double errors = 0.0;
  double squares = 0.0;
  for (std::size_t b = 0; b < kVelocityBins; ++b) {
    const double v = velocities.axis().centre(b);
    if (std::abs(v) < 3.0e-3) continue;
    std::size_t right = 1;  // the ends go on
    while (right + 1 < result.points && result.curve[right].velocity_mps < v) ++right;
    const CurvePoint& p = result.curve[right - 1];
    const CurvePoint& q = result.curve[right];
    const double u = (v - p.velocity_mps) / (q.velocity_mps - p.velocity_mps);
    const double error = p.force_n + u * (q.force_n - p.force_n) - std::copysign(level_n, v);
    errors += velocities.mass(b) * error * error;
    squares += velocities.mass(b) * level_n * level_n;
  }
  return std::sqrt(errors / squares);
}

}  // namespace dampline

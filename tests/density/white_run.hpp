// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <memory>

#include "bench/errors.hpp"
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

/// Relative distance of a curve from F sign(v).
inline double curve_error(const MethodResult& result, const VelocityHistogram& velocities,
                          double level_n = kLevelN) {
  return bench::curve_error(result, velocities, level_n, level_n);
}

}  // namespace dampline

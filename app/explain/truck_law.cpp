// SPDX-License-Identifier: MIT
#include <cmath>

#include "app/explain/truck_points.hpp"
#include "dampline/basis/smooth_sign.hpp"

namespace dampline::app {
namespace {

using effect::Effect;

constexpr int kPoints = 30;  // on each side

/// Sensors and modes are no law of the damper.
bool is_damping(const effect::Candidate& c) {
  const bool rider = c.effect == Effect::kUnmodelledMode && c.form != effect::kPitchForm;
  return c.effect != Effect::kTimeSkew && c.effect != Effect::kGainError && !rider;
}

template <std::size_t N>
bool within(int column, int first) {
  return column >= first && column < first + static_cast<int>(N);
}

/// A column in steady sliding at v without deflection, every history long over.
double steady(int column, const effect::Grids& grids, double v) {
  const double sign = smooth_sign(v, effect::kInnerWidthMps);
  if (within<effect::kWidths>(column, effect::kSign))
    return smooth_sign(v, effect::kWidthMps[static_cast<std::size_t>(column - effect::kSign)]);
  if (within<effect::kStribeckSpeeds>(column, effect::kStribeck)) {
    const auto i = static_cast<std::size_t>(column - effect::kStribeck);
    return sign * std::exp(-std::abs(v) / grids.stribeck_mps[i]);
  }
  const bool memory = within<effect::kDahlDistances>(column, effect::kDahl) ||
                      within<effect::kBacklashGaps>(column, effect::kBacklash) ||
                      within<effect::kPitchModes>(column, effect::kPitchSign);
  if (memory) return sign;
  if (column == effect::kSpeedSquared) return v * std::abs(v);
  if (column == effect::kSpeed) return std::abs(v);
  return column == effect::kFrameOnce ? 0.5 * v : 0.0;  // v = 2 z_b' with the wheelsets at rest
}

double sliding_force(const effect::Model& model, const effect::Grids& grids,
                     const effect::ModelFit& fit, double v) {
  effect::ModelFit part = fit;
  int term = effect::ModelFit::kFirstEffect;
  for (std::size_t i = 0; i < model.count; ++i) {
    for (std::size_t r = 0; r < model.effect[i].count; ++r, ++term)
      if (!is_damping(model.effect[i])) part.theta[term] = 0.0;
  }
  effect::Row row;
  for (int c = 0; c < effect::kColumns; ++c) row[c] = steady(c, grids, v);
  return effect::ModelFitter::force(model, part, row);
}

}  // namespace

std::vector<LawRow> truck_law(const effect::Explanation& e, double mass_kg, double reach_mps) {
  std::vector<LawRow> out;
  for (int i = -kPoints; i <= kPoints; ++i) {
    if (i == 0) continue;
    const double v = reach_mps * i / kPoints;
    out.push_back({v, mass_kg * sliding_force(e.base_model, {}, e.base, v),
                   mass_kg * sliding_force(e.model, e.grids, e.final, v)});
  }
  return out;
}

}  // namespace dampline::app

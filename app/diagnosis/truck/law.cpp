// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/law.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

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

/// A column in steady sliding at v without deflection, every history long over. `sign`: of v; 0: as
/// wide as the column has it.
double steady(int column, const effect::Grids& grids, double v, double sign) {
  if (within<effect::kWidths>(column, effect::kSign)) {
    const auto width = static_cast<std::size_t>(column - effect::kSign);
    return sign != 0.0 ? sign : smooth_sign(v, effect::kWidthMps[width]);
  }
  const bool play = within<effect::kBacklashGaps>(column, effect::kBacklash);
  const double width_mps =
      play ? grids.play[static_cast<std::size_t>(column - effect::kBacklash)].width_mps
           : effect::kInnerWidthMps;
  if (sign == 0.0) sign = smooth_sign(v, width_mps);
  if (within<effect::kStribeckSpeeds>(column, effect::kStribeck)) {
    const auto i = static_cast<std::size_t>(column - effect::kStribeck);
    return sign * std::exp(-std::abs(v) / grids.stribeck_mps[i]);
  }
  const bool memory = play || within<effect::kDahlDistances>(column, effect::kDahl) ||
                      within<effect::kPitchModes>(column, effect::kPitchSign);
  if (memory) return sign;
  if (within<effect::kRelaxations>(column, effect::kRelaxing))
    return v * grids.relaxation_s[static_cast<std::size_t>(column - effect::kRelaxing)];
  if (column == effect::kSpeedSquared) return v * std::abs(v);
  if (column == effect::kSpeed) return std::abs(v);
  return column == effect::kFrameOnce ? 0.5 * v : 0.0;  // v = 2 z_b' with the wheelsets at rest
}

effect::Row sliding(const effect::Grids& grids, double v, double sign) {
  effect::Row row;
  for (int c = 0; c < effect::kColumns; ++c) row[c] = steady(c, grids, v, sign);
  return row;
}

/// What a row's force is made of, by the fit's unknowns; those of sensors and modes are 0.
effect::ModelFit::Vector parts_of(const effect::Model& model, const effect::ModelFit& fit,
                                  const effect::Row& row) {
  effect::ModelFit::Vector out = effect::ModelFit::Vector::Zero();
  effect::ModelFit one = fit;
  for (int term = 0; term < fit.terms; ++term) {
    one.theta = effect::ModelFit::Vector::Unit(term);
    out[term] = effect::ModelFitter::force(model, one, row);
  }
  for (std::size_t i = 0; i < model.count; ++i)
    if (!is_damping(model.effect[i]))
      out.segment(effect::ModelFit::first_of(model, i), static_cast<int>(model.effect[i].count))
          .setZero();
  return out;
}

double sliding_force(const effect::Model& model, const effect::Grids& grids,
                     const effect::ModelFit& fit, double v) {
  return parts_of(model, fit, sliding(grids, v, 0.0)).dot(fit.theta);
}

double std_of(const effect::ModelFit& fit, const effect::ModelFit::Vector& parts) {
  return std::sqrt(std::max(parts.dot(fit.covariance.lazyProduct(parts)), 0.0));
}

/// What the level of friction in steady sliding is made of.
effect::ModelFit::Vector level_parts(const effect::Explanation& e) {
  effect::Row row = sliding(e.grids, 0.0, 1.0);
  row.segment<effect::kStribeckSpeeds>(effect::kStribeck).setZero();
  return parts_of(e.model, e.final, row);
}

/// From the fit to newtons: the stated friction, and its deviation, over what the fit has for it.
struct ToNewtons {
  double value{0.0};
  double std{0.0};
  explicit ToNewtons(const effect::Explanation& e) {
    const auto level = level_parts(e);
    value = e.final_coulomb_n.value / level.dot(e.final.theta);
    const double std_of_fit = std_of(e.final, level);
    std = std_of_fit > 0.0 ? e.final_coulomb_n.std / std_of_fit : std::abs(value);
  }
};

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

void put_law(const effect::Explanation& e, std::vector<CurveRow>& curve) {
  const ToNewtons scale{e};
  bool past_zero = false;
  for (CurveRow& row : curve) {
    const double v = row.velocity_mps;
    const bool positive = v > 0.0 || (v == 0.0 && past_zero);
    past_zero = past_zero || v == 0.0;
    const auto parts = parts_of(e.model, e.final, sliding(e.grids, v, positive ? 1.0 : -1.0));
    row.force_n = scale.value * parts.dot(e.final.theta);
    row.std_n = scale.std * std_of(e.final, parts);
  }
}

Estimate final_viscous(const effect::Explanation& e) {
  const ToNewtons scale{e};
  constexpr int kViscous = effect::ModelFit::kFirstEffect;
  return {scale.value * e.final.theta[kViscous],
          scale.std * std::sqrt(std::max(e.final.covariance(kViscous, kViscous), 0.0))};
}

namespace {

/// Parameters that are a coefficient of the fit, in another unit.
bool is_coefficient(effect::Effect effect) {
  return effect == Effect::kViscous || effect == Effect::kQuadraticDamping ||
         effect == Effect::kCubicStiffness || effect == Effect::kQuadraticStiffness ||
         effect == Effect::kAsymmetricStiffness || effect == Effect::kBumpStop ||
         effect == Effect::kTimeSkew;
}

/// A final parameter and which sum of the fit's unknowns it is proportional to.
struct Settling {
  Parameter final;
  effect::ModelFit::Vector parts;
  [[nodiscard]] Estimate of(const effect::ModelFit& fit, const effect::ModelFit& last) const {
    const double value = parts.dot(last.theta);
    const double std = std_of(last, parts);
    if (value == 0.0 || !(std > 0.0)) return {final.value, final.std};
    return {final.value * parts.dot(fit.theta) / value, final.std * std_of(fit, parts) / std};
  }
};

std::vector<Settling> settling_of(const effect::Explanation& e) {
  using Vector = effect::ModelFit::Vector;
  std::vector<Settling> out{
      {{"coulomb", e.final_coulomb_n.value, e.final_coulomb_n.std, "N"}, level_parts(e)},
      {{"stiffness", e.final_stiffness_npm.value, e.final_stiffness_npm.std, "N/m"},
       Vector::Unit(effect::ModelFit::kStiffness)}};
  for (std::size_t i = 0; i < e.model.count; ++i) {
    const effect::Candidate& c = e.model.effect[i];
    if (i >= e.base_count && c.count > 0 && is_coefficient(c.effect)) {
      const effect::EffectParameter& p = e.step[i - e.base_count].parameter[0];
      out.push_back({{p.name, p.estimate.value, p.estimate.std, p.unit},
                     Vector::Unit(effect::ModelFit::first_of(e.model, i))});
    }
  }
  return out;
}

}  // namespace

Convergence convergence_of(const effect::Explanation& e, const effect::GramStore& store,
                           double duration_s) {
  constexpr std::size_t kFewestEntries = 8;
  Convergence out;
  const std::vector<Settling> settling = settling_of(e);
  for (const Settling& s : settling) {
    out.names.push_back(s.final.name);
    out.units.push_back(s.final.unit);
  }
  const auto part = std::make_unique<effect::GramStore>(store);
  const auto evidence = std::make_unique<effect::Evidence>();
  effect::ModelFitter fitter{*evidence};
  for (std::size_t count = store.count(); count >= kFewestEntries; --count) {
    part->keep_oldest(count);
    if (!evidence->load(*part)) continue;
    evidence->weigh(*part, e.weight);
    const effect::ModelFit fit = count < store.count() ? fitter.fit(e.model) : e.final;
    if (!fit.ok) continue;
    Convergence::Row row{
        duration_s * static_cast<double>(count) / static_cast<double>(store.count()), {}};
    for (const Settling& s : settling) row.estimates.push_back(s.of(fit, e.final));
    out.rows.push_back(std::move(row));
  }
  std::reverse(out.rows.begin(), out.rows.end());
  return out;
}

}  // namespace dampline::app

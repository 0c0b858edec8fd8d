// SPDX-License-Identifier: MIT
#include "dampline/effect/conclusion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dampline/estimate/weighted_fit.hpp"

namespace dampline::effect {
namespace {

constexpr double kUnexplainedAbove = 1.25;  // of the floor, without a single step
constexpr double kUnexplainedAboveWithImpacts = 1.5;
constexpr std::uint64_t kImpacts = 10;

/// Of a pitch frequency: its law is one of short steps, and a lower one with more slip leaves
/// alike.
constexpr double kPitchLawStd = 0.04;

/// What a step's parameters are made of.
struct Source {
  const ModelFit& fit;
  int term;  // of the effect's first coefficient
  double mass_kg;
  const Grids& grids;
  double factor;  // on deviations, for few entries

  [[nodiscard]] Estimate coefficient(int offset, double scale) const noexcept {
    const int i = term + offset;
    return {scale * fit.theta[i],
            std::abs(scale) * factor * std::sqrt(std::max(fit.covariance(i, i), 0.0))};
  }
  /// A coefficient divided by the friction level, with the level taken as known.
  [[nodiscard]] Estimate share() const noexcept {
    return coefficient(0, 1.0 / fit.theta[ModelFit::kCoulomb]);
  }
};

void put(Step& step, const char* name, const Estimate& estimate, const char* unit) noexcept {
  step.parameter[step.parameter_count++] = {name, estimate, unit};
}

/// A place between the points of a grid, by its logarithm.
template <std::size_t N>
Estimate on_grid(const std::array<double, N>& grid, const Step& step, double unit) noexcept {
  const auto low =
      static_cast<std::size_t>(std::clamp(step.place, 0.0, static_cast<double>(N) - 2.0));
  const double ratio = grid[low + 1] / grid[low];
  const double value = unit * grid[low] * std::pow(ratio, step.place - static_cast<double>(low));
  return {value, value * std::log(ratio) * step.place_std};
}

/// Sum of the coefficients of a pair.
Estimate sum_of(const Source& s, const Step& step, double scale) noexcept {
  const Estimate first = s.coefficient(0, scale);
  if (step.chosen.count < 2) return first;
  const Estimate second = s.coefficient(1, scale);
  const double both =
      2.0 * scale * scale * s.factor * s.factor * s.fit.covariance(s.term, s.term + 1);
  return {first.value + second.value,
          std::sqrt(std::max(first.std * first.std + second.std * second.std + both, 0.0))};
}

void describe_damping(const Source& s, Step& step) noexcept {
  switch (step.chosen.effect) {
    case Effect::kViscous:
      return put(step, "viscous", s.coefficient(0, s.mass_kg), "N s/m");
    case Effect::kQuadraticDamping:
      return put(step, "quadratic_damping", s.coefficient(0, s.mass_kg), "N s^2/m^2");
    case Effect::kAsymmetricViscous: {
      const Estimate even = s.coefficient(0, s.mass_kg);
      const Estimate odd = s.coefficient(1, s.mass_kg);
      const double covariance =
          s.mass_kg * s.mass_kg * s.factor * s.factor * s.fit.covariance(s.term, s.term + 1);
      const double squares = even.std * even.std + odd.std * odd.std;
      put(step, "viscous_positive",
          {odd.value + even.value, std::sqrt(std::max(squares + 2.0 * covariance, 0.0))}, "N s/m");
      return put(step, "viscous_negative",
                 {odd.value - even.value, std::sqrt(std::max(squares - 2.0 * covariance, 0.0))},
                 "N s/m");
    }
    default:
      return;
  }
}

void describe_friction(const Source& s, Step& step) noexcept {
  switch (step.chosen.effect) {
    case Effect::kProgressiveFriction: {
      // F (1 + y / length)
      const Estimate slope = s.share();
      const double length_m = 1.0 / slope.value;
      return put(step, "progressive_friction_length",
                 {length_m, std::abs(length_m * slope.std / slope.value)}, "m");
    }
    case Effect::kStribeck:
      put(step, "stribeck_share", s.share(), "");
      return put(step, "stribeck_speed", on_grid(s.grids.stribeck_mps, step, 1.0), "m/s");
    case Effect::kPreslidingHysteresis:
      put(step, "presliding_hysteresis_force", sum_of(s, step, s.mass_kg), "N");
      return put(step, "presliding_hysteresis_distance",
                 on_grid(s.grids.dahl_distance, step, s.grids.scale_m), "m");
    case Effect::kBacklash:
      put(step, "backlash_force", sum_of(s, step, s.mass_kg), "N");
      return put(step, "backlash_gap", on_grid(s.grids.backlash_gap, step, s.grids.scale_m), "m");
    default:
      return;
  }
}

void describe_stiffness(const Source& s, Step& step) noexcept {
  switch (step.chosen.effect) {
    case Effect::kCubicStiffness:
      return put(step, "cubic_stiffness", s.coefficient(0, s.mass_kg), "N/m^3");
    case Effect::kQuadraticStiffness:
      return put(step, "quadratic_stiffness", s.coefficient(0, s.mass_kg), "N/m^2");
    case Effect::kAsymmetricStiffness:
      // k y + theta |y|: k + theta for y > 0, k - theta for y < 0
      return put(step, "asymmetric_stiffness_difference", s.coefficient(0, 2.0 * s.mass_kg), "N/m");
    case Effect::kBumpStop:
      put(step, "bump_stop_stiffness", s.coefficient(0, s.mass_kg), "N/m");
      return put(step, "bump_stop_gap", on_grid(s.grids.bump_gap, step, s.grids.scale_m), "m");
    default:
      return;
  }
}

void describe_mode(const Source& s, Step& step) noexcept {
  if (step.chosen.form == kPitchForm) {
    const double ratio = s.grids.pitch[1].frequency_hz / s.grids.pitch[0].frequency_hz;
    const double hz = pitch_of(step, s.grids).frequency_hz;
    const double std = std::hypot(std::log(ratio) * step.place_std, kPitchLawStd);
    put(step, "unmodelled_mode_frequency", {hz, hz * std}, "Hz");
    return put(step, "unmodelled_mode_force", s.coefficient(0, s.mass_kg), "N");
  }
  // t = (k X_k + F X_F - m B) / (1 - m): the coefficient is -m / (1 - m), m of all mass.
  const Estimate ratio = sum_of(s, step, -1.0);
  const double left = 1.0 / (1.0 + ratio.value);
  const double step_ratio = s.grids.flexible[1].frequency_hz / s.grids.flexible[0].frequency_hz;
  const double hz = flexible_of(step, s.grids).frequency_hz;
  put(step, "unmodelled_mode_frequency", {hz, hz * std::log(step_ratio) * step.place_std}, "Hz");
  put(step, "unmodelled_mode_mass",
      {s.mass_kg * ratio.value * left, s.mass_kg * ratio.std * left * left}, "kg");
}

void describe_rest(const Source& s, Step& step) noexcept {
  constexpr std::array<const char*, 3> kSkew{"time_skew_frame", "time_skew_wheelset1",
                                             "time_skew_wheelset2"};
  constexpr std::array<const char*, 3> kGain{"gain_error_frame", "gain_error_wheelset1",
                                             "gain_error_wheelset2"};
  switch (step.chosen.effect) {
    case Effect::kTimeSkew:
      return put(step, kSkew[step.chosen.form], s.coefficient(0, 1.0), "s");
    case Effect::kGainError: {
      const Estimate e = s.coefficient(0, 1.0);
      if (step.chosen.form != kFrameForm) return put(step, kGain[step.chosen.form], e, "");
      // z_b'' = (1 - e) times what is measured, which is 1 + gain times it.
      const double left = 1.0 / (1.0 - e.value);
      return put(step, kGain[step.chosen.form], {e.value * left, e.std * left * left}, "");
    }
    case Effect::kUnmodelledMode:
      return describe_mode(s, step);
    default:
      return;
  }
}

/// What multiplies every coefficient. With a mass on the frame that is the frame's own share of all
/// moving mass; a frame's sensor that shows too much stretches all forces.
double own_share(const ModelFit& fit, const Model& model) noexcept {
  double ratio = 0.0;
  double stretch = 1.0;
  int term = ModelFit::kFirstEffect;
  for (std::size_t i = 0; i < model.count; ++i) {
    const Candidate& c = model.effect[i];
    if (c.effect == Effect::kUnmodelledMode && c.form == kFlexibleForm) {
      for (std::size_t r = 0; r < c.count; ++r) ratio -= fit.theta[term + static_cast<int>(r)];
    }
    if (c.effect == Effect::kGainError && c.form == kFrameForm) stretch -= fit.theta[term];
    term += static_cast<int>(c.count);
  }
  return stretch / (1.0 + ratio);
}

/// Friction that a history replaced still counts: the level is what multiplies +-1 in steady
/// sliding.
Estimate level(const ModelFit& fit, const Model& model, double mass_kg, double factor) noexcept {
  ModelFit::Vector gradient = ModelFit::Vector::Zero();
  gradient[ModelFit::kCoulomb] = 1.0;
  int term = ModelFit::kFirstEffect;
  for (std::size_t i = 0; i < model.count; ++i) {
    const Candidate& c = model.effect[i];
    const bool sliding = c.effect == Effect::kPreslidingHysteresis ||
                         c.effect == Effect::kBacklash ||
                         (c.effect == Effect::kUnmodelledMode && c.form == kPitchForm);
    if (sliding) gradient[term] = 1.0;
    if (sliding && c.count > 1) gradient[term + 1] = 1.0;
    term += static_cast<int>(c.count);
  }
  const double variance = gradient.dot(fit.covariance.lazyProduct(gradient));
  const double scale = mass_kg * own_share(fit, model);
  return {scale * gradient.dot(fit.theta), scale * factor * std::sqrt(std::max(variance, 0.0))};
}

Estimate spring(const ModelFit& fit, const Model& model, double mass_kg, double factor) noexcept {
  const double variance = fit.covariance(ModelFit::kStiffness, ModelFit::kStiffness);
  const double scale = mass_kg * own_share(fit, model);
  return {scale * fit.theta[ModelFit::kStiffness],
          scale * factor * std::sqrt(std::max(variance, 0.0))};
}

}  // namespace

const char* name_of(Conclusion conclusion) noexcept {
  switch (conclusion) {
    case Conclusion::kNotReady:
      return "not_ready";
    case Conclusion::kComplete:
      return "complete";
    case Conclusion::kExplained:
      return "explained";
    case Conclusion::kPartlyExplained:
      return "partly_explained";
    case Conclusion::kUnexplained:
      break;
  }
  return "unexplained";
}

double base_error(const Explanation& e) noexcept {
  const bool restated = e.step_count > 0 && e.base_restated_nmse > 0.0;
  return restated ? e.base_restated_nmse : e.base.held_out_nmse;
}

double error_beside(const Step& step, const RunnerUp& runner_up) noexcept {
  return step.restated_before > 0.0 ? (1.0 - runner_up.gain) * step.restated_before
                                    : runner_up.held_out_nmse;
}

double floor_ratio(const Explanation& e) noexcept {
  if (!(e.floor_nmse > 0.0)) return 0.0;
  double left = e.final.held_out_nmse;
  for (std::size_t i = 0; i < e.step_count; ++i) {
    if (e.step[i].chosen.effect == Effect::kImpulsiveInput) left *= 1.0 - e.step[i].gain;
  }
  return left / e.floor_nmse;
}

bool is_possible(const Explanation& e) noexcept {
  return e.final_coulomb_n.value > 0.0 && e.final_stiffness_npm.value > 0.0;
}

void conclude(std::uint64_t impacts, Explanation& e) noexcept {
  const double ratio = is_possible(e) ? floor_ratio(e) : std::numeric_limits<double>::infinity();
  const double limit = impacts >= kImpacts ? kUnexplainedAboveWithImpacts : kUnexplainedAbove;
  if (e.step_count == 0) {
    e.conclusion = ratio > limit ? Conclusion::kUnexplained : Conclusion::kComplete;
  } else {
    e.conclusion = ratio > kIncompleteAbove ? Conclusion::kPartlyExplained : Conclusion::kExplained;
  }
}

Model remembering_part(const Explanation& e) noexcept {
  Model out = e.base_model;
  for (std::size_t i = e.base_count; i < e.model.count; ++i) {
    if (has_memory(e.model.effect[i].effect)) out = out.with(e.model.effect[i]);
  }
  return out;
}

void drop_steps(Explanation& e) noexcept {
  e.step_count = 0;
  e.model = e.base_model;
  e.final = e.base;
  e.weight = e.base_weight;
  e.target = e.base_target;
  e.floor_nmse = e.base_floor_nmse;
  e.final_coulomb_n = e.base_coulomb_n;
  e.final_stiffness_npm = e.base_stiffness_npm;
}

void describe(double mass_kg, Explanation& out) noexcept {
  std::size_t entries = 0;
  for (const double e : out.base.held_out_error) entries += e > 0.0 ? 1 : 0;
  const double factor = short_record_factor(static_cast<double>(entries));
  out.base_coulomb_n = level(out.base, out.base_model, mass_kg, factor);
  out.base_stiffness_npm = spring(out.base, out.base_model, mass_kg, factor);
  out.final_coulomb_n = level(out.final, out.model, mass_kg, factor);
  out.final_stiffness_npm = spring(out.final, out.model, mass_kg, factor);
  int term = ModelFit::kFirstEffect + static_cast<int>(out.base_count);
  for (std::size_t i = 0; i < out.step_count && out.base_count + i < out.model.count; ++i) {
    const std::size_t count = out.model.effect[out.base_count + i].count;
    if (count == 0) continue;
    const Source source{out.final, term, mass_kg, out.grids, factor};
    out.step[i].parameter_count = 0;
    describe_damping(source, out.step[i]);
    describe_friction(source, out.step[i]);
    describe_stiffness(source, out.step[i]);
    describe_rest(source, out.step[i]);
    term += static_cast<int>(count);
  }
}

}  // namespace dampline::effect

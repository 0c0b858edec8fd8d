// SPDX-License-Identifier: MIT
#include "dampline/effect/explainer.hpp"

#include <algorithm>
#include <cmath>

#include "dampline/effect/rules.hpp"
#include "dampline/estimate/weighted_fit.hpp"

namespace dampline::effect {
namespace {

constexpr std::size_t kFewestEntries = 10;
constexpr double kSkewGain = 0.025;  // below, a time skew is no candidate
constexpr double kNeeded = 0.01;     // loss without it that keeps an effect in the model
constexpr double kReadjusted = 0.999;
constexpr double kSimplerWithin = 0.02;
constexpr double kDirectionZ = 7.0;     // of damping that differs by direction ...
constexpr double kDirectionT = 3.0;     // ... beside the best with one coefficient
constexpr double kImpulseShare = 0.08;  // of the residual's energy in large values
constexpr std::uint64_t kFewestImpulses = 6;
constexpr int kWeightIterations = 3;

/// Impacts that no sensor measured are no column: the rows that they reach are known by their size.
void add_impulses(const ImpulseMeter& meter, const ModelFit& now, Explanation& out) noexcept {
  if (meter.share() < kImpulseShare || meter.events() < kFewestImpulses) return;
  Step& step = out.step[out.step_count++];
  step = {};
  step.chosen.effect = Effect::kImpulsiveInput;
  step.held_out_nmse_before = now.held_out_nmse;
  step.held_out_nmse_after = (1.0 - meter.share()) * now.held_out_nmse;
  step.gain = meter.share();
  step.parameter[step.parameter_count++] = {
      "impulsive_input_events",
      {static_cast<double>(meter.events()), std::sqrt(static_cast<double>(meter.events()))},
      ""};
}

void remove_step(Explanation& e, std::size_t i) noexcept {
  e.model = e.model.without(e.base_count + i);
  std::shift_left(e.step.begin() + static_cast<std::ptrdiff_t>(i), e.step.end(), 1);
  --e.step_count;
}

/// Of two forms that explain alike, the plainer one.
double handicap(const Candidate& candidate) noexcept {
  const bool between = is_pair(candidate);
  const bool one_sided = candidate.effect == Effect::kBumpStop && candidate.form != kPlainForm;
  return 1.0 + (between ? 0.01 : 0.0) + (one_sided ? 0.015 : 0.0);
}

/// Where the parabola through three errors is least, in steps from the middle one.
double vertex(const std::array<double, 2>& side, double middle) noexcept {
  const double curvature = side[0] + side[1] - 2.0 * middle;
  if (!(side[0] > 0.0 && side[1] > 0.0 && curvature > 0.0)) return 0.0;
  return std::clamp(0.5 * (side[0] - side[1]) / curvature, -0.5, 0.5);
}

constexpr double kSurrogateGains = 2.0;  // what a real effect gains over the surrogate's gain
/// A channel that was set right is no column: what that took is known by the errors before and
/// after.
bool was_late(const Step& step, const Candidate& added) noexcept {
  return step.chosen.effect == Effect::kTimeSkew && added.count == 0;
}
double lateness_ratio(const Step& step) noexcept {
  return step.held_out_nmse_before / step.held_out_nmse_after;
}

void scale_runners_up(double factor, Step& step) noexcept {
  for (std::size_t r = 0; r < step.runner_up_count; ++r) step.runner_up[r].held_out_nmse *= factor;
}

}  // namespace

void Explainer::try_all(const Model& model, const ModelFit& now, BestOfEffects& best) noexcept {
  best = {};
  list_candidates(base_of(now), grids_, candidates_);
  for (std::size_t i = 0; i < candidates_.count; ++i) {
    const Candidate& candidate = candidates_.item[i];
    if (!has_room(model, candidate, two_late_)) continue;
    if (!allowed_[static_cast<std::size_t>(candidate.effect)]) continue;
    if (is_kink_of_spring(model, candidate, grids_)) continue;
    const ModelFit fit = fitter_.fit(model.with(candidate));
    if (!fit.ok || !is_plausible(candidate, fit, now.terms) || !is_plausible(model, fit)) continue;
    const bool tiny = fit.held_out_nmse > (1.0 - kSkewGain) * now.held_out_nmse;
    if (candidate.effect == Effect::kTimeSkew && tiny) continue;
    Best& b = best[static_cast<std::size_t>(candidate.effect)];
    const double judged = handicap(candidate) * fit.held_out_nmse;
    if (b.ok && judged >= b.judged) continue;
    b = {true, candidate, fit.held_out_nmse, judged};
  }
}

ModelFit Explainer::settle(const GramStore& store, Model& model) noexcept {
  ModelFit fit = fitter_.fit(model);
  for (int i = 0; i < kWeightIterations && fit.ok; ++i) {
    evidence_.weigh(store, fitter_.weights_of(model, fit));
    for (std::size_t e = 0; e < model.count; ++e) refresh(base_of(fit), model.effect[e]);
    fit = fitter_.fit(model);
  }
  return fit;
}

RunnerUp Explainer::runner_up_of(const Model& model, const Candidate& candidate,
                                 const ModelFit& now) noexcept {
  const ModelFit fit = fitter_.fit(model.with(candidate));
  return {candidate.effect, fit.held_out_nmse, 1.0 - fit.held_out_nmse / now.held_out_nmse,
          block_t(now, fit, evidence_.count), coefficient_t(fit, now)};
}

/// Of damping that differs by direction and the best with one coefficient, the plainer one unless
/// the difference of the directions is sure, and large beside effects whose imperfections have a
/// direction, too; else the first.
std::size_t Explainer::plainer(const Model& model, const Best* const* order, std::size_t found,
                               const ModelFit& now) noexcept {
  if (order[0]->candidate.effect != Effect::kAsymmetricViscous) return 0;
  std::size_t plain = 1;
  while (plain < found && order[plain]->candidate.count != 1) ++plain;
  if (plain == found) return 0;
  const ModelFit rich = fitter_.fit(model.with(order[0]->candidate));
  if (coefficient_t(rich, now) < kDirectionZ) return plain;
  const ModelFit fit = fitter_.fit(model.with(order[plain]->candidate));
  const bool later = model.count > 0;
  const bool alike = fit.held_out_nmse < (1.0 + kSimplerWithin) * rich.held_out_nmse;
  if (later && alike) return plain;
  return block_t(fit, rich, evidence_.count) < kDirectionT ? plain : 0;
}

bool Explainer::forward(Explanation& out, const ModelFit& now) noexcept {
  if (out.step_count == Explanation::kMostSteps) return false;
  BestOfEffects best;
  try_all(out.model, now, best);
  std::array<const Best*, kEffects> order{};
  std::size_t found = 0;
  for (const Best& b : best) {
    if (b.ok) order[found++] = &b;
  }
  if (found == 0) return false;
  std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(found),
            [](const Best* a, const Best* b) { return a->judged < b->judged; });
  const std::size_t pick = plainer(out.model, order.data(), found, now);
  std::swap(order[0], order[pick]);
  for (std::size_t c = 0; c < found; ++c) {
    const Step step = step_of(out.model, order.data(), found, c, now);
    if (c == 0) out.rejected = step;
    const Verdict verdict = judge_step(out.model, out.step_count == 0, c == 0, step);
    if (verdict == Verdict::kStop) return false;
    if (verdict == Verdict::kNo) continue;
    out.model = out.model.with(step.chosen);
    out.step[out.step_count++] = step;
    out.rejected = {};
    return true;
  }
  return false;
}

/// Each effect again at every point of its grid, now that the others are in the model; the steps
/// keep the gains that they were chosen for.
bool Explainer::readjust(Explanation& out, ModelFit& now) noexcept {
  bool any = false;
  for (std::size_t i = 0; i < out.step_count; ++i) {
    Candidate& place = out.model.effect[out.base_count + i];
    if (place.count == 0) continue;
    const Candidate before = place;
    Best best{true, before, now.held_out_nmse, handicap(before) * now.held_out_nmse};
    list_candidates(base_of(now), grids_, candidates_);
    const int term = ModelFit::first_of(out.model, out.base_count + i);
    for (std::size_t c = 0; c < candidates_.count; ++c) {
      if (!is_of_grid(candidates_.item[c], before)) continue;
      if (is_kink_of_spring(out.model, candidates_.item[c], grids_)) continue;
      place = candidates_.item[c];
      const ModelFit fit = fitter_.fit(out.model);
      if (!fit.ok || !is_plausible(place, fit, term) || !is_plausible(out.model, fit)) continue;
      const double judged = handicap(place) * fit.held_out_nmse;
      if (judged < kReadjusted * best.judged) best = {true, place, fit.held_out_nmse, judged};
    }
    place = best.candidate;
    out.step[i].chosen = best.candidate;
    if (best.held_out_nmse == now.held_out_nmse) continue;
    now = fitter_.fit(out.model);
    any = true;
  }
  return any;
}

/// The c-th of the best candidates beside the others. One that leaves less was passed over, since
/// it can do more and its lead is no more than that: it is no runner-up.
Step Explainer::step_of(const Model& model, const Best* const* order, std::size_t found,
                        std::size_t c, const ModelFit& now) noexcept {
  const ModelFit fit = fitter_.fit(model.with(order[c]->candidate));
  Step step;
  step.chosen = order[c]->candidate;
  step.held_out_nmse_before = now.held_out_nmse;
  step.held_out_nmse_after = fit.held_out_nmse;
  step.gain = 1.0 - fit.held_out_nmse / now.held_out_nmse;
  step.block_t = block_t(now, fit, evidence_.count);
  step.coefficient_t = coefficient_t(fit, now);
  for (std::size_t i = 0; i < found && step.runner_up_count < Step::kMostRunnersUp; ++i) {
    if (i == c || order[i]->held_out_nmse < fit.held_out_nmse) continue;
    step.other[step.runner_up_count] = order[i]->candidate;
    step.runner_up[step.runner_up_count++] = runner_up_of(model, order[i]->candidate, now);
  }
  return step;
}

void Explainer::backward(Explanation& out, ModelFit& now) noexcept {
  for (std::size_t i = 0; out.step_count > 1 && i < out.step_count;) {
    if (out.model.effect[out.base_count + i].count == 0) {
      ++i;
      continue;
    }
    const ModelFit without = fitter_.fit(out.model.without(out.base_count + i));
    if (!without.ok || without.held_out_nmse > (1.0 + kNeeded) * now.held_out_nmse) {
      ++i;
      continue;
    }
    remove_step(out, i);
    now = without;
    i = 0;
  }
}

Explanation Explainer::explain(const Sums& sums, const ExplainerConfig& config) noexcept {
  Explanation out;
  out.grids = grids_ = sums.grids;
  detail_.velocity = sums.velocity;
  detail_.deflection_rms_m = sums.deflection_rms_m;
  const GramStore& store = sums.store;
  if (store.count() < kFewestEntries || !evidence_.load(store)) return out;
  allowed_ = config.allowed;
  two_late_ = config.two_late;
  if (config.base_viscous) {
    list_candidates({}, grids_, candidates_);
    out.model = out.model.with(candidates_.item[0]);
    out.base_count = 1;
  }
  out.base_model = out.model;
  ModelFit now = settle(store, out.model);
  if (!now.ok) return out;
  out.base = now;
  out.base_weight = evidence_.weight;
  out.base_target = evidence_.total.at(kTarget, kTarget);
  look_into(store, out.model, config.moving_mass_kg);
  const BaseParameters base = base_parameters(detail_);
  out.base_coulomb_n = base.coulomb_n;
  out.base_stiffness_npm = base.stiffness_npm;
  if (config.known != nullptr) keep(store, *config.known, out, now);
  while (forward(out, now)) {
    now = settle(store, out.model);
    if (readjust(out, now)) now = settle(store, out.model);
  }
  const bool impulses = allowed_[static_cast<std::size_t>(Effect::kImpulsiveInput)];
  if (out.step_count == 0 && impulses) add_impulses(sums.impulses, now, out);
  backward(out, now);
  do {
    out.final = settle(store, out.model);
    restate(out);
  } while (drop_worthless(out));
  out.weight = evidence_.weight;
  out.target = evidence_.total.at(kTarget, kTarget);
  for (std::size_t i = 0; i + out.base_count < out.model.count; ++i)
    refine(out.model, out.base_count + i, out.final, out.step[i]);
  look_into(store, out.model, config.moving_mass_kg);
  describe(detail_, out);
  if (out.step_count > 0)
    out.final.held_out_nmse = out.step[out.step_count - 1].restated_after;
  else
    drop_steps(out);
  out.floor_nmse = config.floor_nmse;
  conclude(0, out);
  return out;
}

void Explainer::look_into(const GramStore& store, const Model& model, double mass_kg) noexcept {
  detail_.mass_kg = mass_kg;
  detail_.factor = short_record_factor(static_cast<double>(evidence_.count));
  detail_.model = model;
  for (std::size_t i = 0; i < model.count; ++i)
    detail_.model.effect[i] = with_slopes(model.effect[i], grids_);
  detail_.fit = fitter_.fit(detail_.model);
  if (!detail_.fit.ok) {
    detail_.model = model;
    detail_.fit = fitter_.fit(model);
  }
  const ScaleWeights weights = evidence_.weight;
  ScaleWeights slow = weights;
  slow.back() = 0.0;
  evidence_.weigh(store, slow);
  Model same = detail_.model;
  detail_.slow = settle(store, same);
  if (!detail_.slow.ok) detail_.slow = detail_.fit;
  evidence_.weigh(store, weights);
}

/// Where the error is least between the points of a wide grid, by which a finer one is drawn: the
/// vertex of the parabola through it and its neighbours.
void Explainer::refine(const Model& model, std::size_t i, const ModelFit& final,
                       Step& step) noexcept {
  const Candidate& chosen = step.chosen;
  if (grids_.is_fine(chosen.effect)) return;
  step.place = chosen.variant;
  if (is_pair(chosen)) {
    const int term = ModelFit::first_of(model, i);
    const double low = std::abs(final.theta[term]);
    const double high = std::abs(final.theta[term + 1]);
    step.place += high / (low + high);
    return;
  }
  list_candidates(base_of(final), grids_, candidates_);
  const std::size_t line = line_of(chosen.effect, chosen.form == kPitchForm, grids_);
  step.place += vertex(beside(model, i, 1, true), final.nmse);
  step.line_offset = vertex(beside(model, i, static_cast<int>(line), false), final.nmse);
}

std::array<double, 2> Explainer::beside(const Model& model, std::size_t i, int apart,
                                        bool in_line) noexcept {
  std::array<double, 2> out{};
  const Candidate& chosen = model.effect[i];
  const std::size_t line = line_of(chosen.effect, chosen.form == kPitchForm, grids_);
  for (std::size_t c = 0; c < candidates_.count; ++c) {
    const Candidate& other = candidates_.item[c];
    if (!is_of_grid(other, chosen) || other.count != 1) continue;
    const int distance = static_cast<int>(other.variant) - static_cast<int>(chosen.variant);
    const bool one_line = other.variant / line == chosen.variant / line;
    if ((distance != apart && distance != -apart) || one_line != in_line) continue;
    Model neighbour = model;
    neighbour.effect[i] = other;
    out[distance > 0 ? 1 : 0] = fitter_.fit(neighbour).nmse;
  }
  return out;
}

/// What an explanation by other sums knows already: the first effect, at the point of its grid that
/// is now the best, and a late channel, which is no column any more.
void Explainer::keep(const GramStore& store, const Explanation& known, Explanation& out,
                     ModelFit& now) noexcept {
  std::size_t newest_late = 0;
  for (std::size_t i = 0; i < known.step_count; ++i)
    if (known.step[i].chosen.effect == Effect::kTimeSkew) newest_late = i;
  for (std::size_t i = 0; i < known.step_count; ++i) {
    const bool late = known.step[i].chosen.effect == Effect::kTimeSkew;
    if (i > 0 && !late) continue;
    Step step = known.step[i];
    Candidate member = step.chosen;
    if (late) {
      member.count = 0;
    } else {
      BestOfEffects best;
      try_all(out.model, now, best);
      const Best& b = best[static_cast<std::size_t>(member.effect)];
      if (!b.ok) continue;
      step.chosen = member = b.candidate;
    }
    out.model = out.model.with(member);
    now = settle(store, out.model);
    if (late && i == newest_late) {
      // More than its column to first order, by which it was chosen; in other weights hardly less.
      step.gain = std::max(step.gain, 1.0 - now.held_out_nmse / step.held_out_nmse_before);
      step.held_out_nmse_after = (1.0 - step.gain) * step.held_out_nmse_before;
    }
    out.step[out.step_count++] = step;
  }
  out.base = known.base;
  out.base_weight = known.base_weight;
  out.base_target = known.base_target;
}

void Explainer::restate_runners_up(const Model& model, const ModelFit& now, Step& step) noexcept {
  for (std::size_t r = 0; r < step.runner_up_count; ++r) {
    refresh(base_of(now), step.other[r]);
    step.runner_up[r] = runner_up_of(model, step.other[r], now);
  }
}

void Explainer::restate(Explanation& e) noexcept {
  double late = 1.0;
  for (std::size_t i = 0; i < e.step_count; ++i) {
    if (was_late(e.step[i], e.model.effect[e.base_count + i])) late *= lateness_ratio(e.step[i]);
  }
  Model model = e.base_model;
  ModelFit now = fitter_.fit(model);
  e.base_restated_nmse = late * now.held_out_nmse;
  double before = e.base_restated_nmse;
  for (std::size_t i = 0; i < e.step_count; ++i) {
    Step& step = e.step[i];
    const Candidate& added = e.model.effect[e.base_count + i];
    step.restated_before = before;
    if (step.chosen.effect == Effect::kImpulsiveInput) {
      step.restated_after = before *= 1.0 - step.gain;
      continue;
    }
    if (was_late(step, added)) {
      late /= lateness_ratio(step);
      scale_runners_up(before / step.held_out_nmse_before, step);
    } else {
      restate_runners_up(model, now, step);
      scale_runners_up(late, step);
      model = model.with(added);
      now = fitter_.fit(model);
    }
    step.restated_after = before = late * now.held_out_nmse;
  }
}

bool Explainer::drop_worthless(Explanation& e) noexcept {
  for (std::size_t i = 0; i < e.step_count; ++i) {
    // What is no column is known otherwise: a channel that was set right, impacts.
    const bool is_column = e.model.effect[e.base_count + i].count > 0;
    if (!is_column || e.step[i].restated_after < e.step[i].restated_before) continue;
    remove_step(e, i);
    return true;
  }
  return false;
}

Explainer::Prediction Explainer::predict(const Diagnosis& other, const Explanation& by) noexcept {
  if (other.store().count() == 0 || !evidence_.load(other.store())) return {};
  evidence_.weigh(other.store(), by.weight);
  return {fitter_.nmse_of(by.base_model, by.base), fitter_.nmse_of(by.model, by.final)};
}

double Explainer::left_of_surrogate(const Diagnosis& surrogate, const Model& model,
                                    const ScaleWeights& weights, double target) noexcept {
  if (surrogate.store().count() < kFewestEntries || !evidence_.load(surrogate.store())) return -1.0;
  evidence_.weigh(surrogate.store(), weights);
  const ModelFit fit = fitter_.fit(model);
  return fit.ok ? fit.held_out_nmse * evidence_.total.at(kTarget, kTarget) / target : -1.0;
}

bool Explainer::apply_floor(const Surrogates& surrogates, std::uint64_t impacts,
                            Explanation& e) noexcept {
  const auto mean_of = [&](const ScaleWeights& weights, double target) {
    const double first = left_of_surrogate(surrogates.base, e.base_model, weights, target);
    if (surrogates.other_noise == nullptr || first < 0.0) return first;
    const double second = left_of_surrogate(*surrogates.other_noise, e.base_model, weights, target);
    return second < 0.0 ? second : 0.5 * (first + second);
  };
  const double base_floor = mean_of(e.base_weight, surrogates.share * e.base_target);
  if (base_floor < 0.0) return false;
  e.base_floor_nmse = base_floor;
  if (!beats_surrogate(surrogates.base, e)) drop_steps(e);
  const Model law = law_part(e);
  const bool found = surrogates.found != nullptr && law.count > e.base_count;
  const double target = surrogates.share * e.target;
  const double floor = found ? left_of_surrogate(*surrogates.found, law, e.weight, target)
                             : mean_of(e.weight, target);
  if (floor < 0.0) return false;
  e.floor_nmse = floor;
  conclude(impacts, e, surrogates.unexplained_above);
  return true;
}

std::array<Estimate, kChannels> Explainer::lateness(const Diagnosis& diagnosis, const Model& model,
                                                    const Model& late) noexcept {
  std::array<Estimate, kChannels> out{};
  if (diagnosis.store().count() < kFewestEntries || !evidence_.load(diagnosis.store())) return out;
  Model with;
  for (std::size_t i = 0; i < model.count; ++i)
    if (model.effect[i].effect != Effect::kTimeSkew) with = with.with(model.effect[i]);
  const std::size_t others = with.count;
  for (std::size_t i = 0; i < late.count; ++i) with = with.with(late.effect[i]);
  const ModelFit fit = settle(diagnosis.store(), with);
  if (!fit.ok) return out;
  for (std::size_t i = others; i < with.count; ++i) {
    const int term = ModelFit::first_of(with, i);
    out[with.effect[i].form] = {fit.theta[term],
                                std::sqrt(std::max(fit.covariance(term, term), 0.0))};
  }
  return out;
}

/// Large residuals, too, are rare in time on a surrogate without impacts: those of sticking.
bool Explainer::beats_surrogate(const Diagnosis& surrogate, const Explanation& e) noexcept {
  if (e.step_count == 0) return true;
  double gain = surrogate.impulses().share();
  if (e.step[0].chosen.count > 0) {
    const double without = left_of_surrogate(surrogate, e.base_model, e.base_weight, e.base_target);
    const double with = left_of_surrogate(surrogate, e.base_model.with(e.step[0].chosen),
                                          e.base_weight, e.base_target);
    gain = with < 0.0 ? 0.0 : 1.0 - with / without;
  }
  return e.step[0].gain >= kSurrogateGains * gain;
}

}  // namespace dampline::effect

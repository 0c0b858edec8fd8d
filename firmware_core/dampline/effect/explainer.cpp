// SPDX-License-Identifier: MIT
#include "dampline/effect/explainer.hpp"

#include <algorithm>
#include <cmath>

#include "dampline/effect/rules.hpp"

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

/// Where the coefficients of a model's i-th effect begin.
int first_term(const Model& model, std::size_t i) noexcept {
  int term = ModelFit::kFirstEffect;
  for (std::size_t e = 0; e < i; ++e) term += static_cast<int>(model.effect[e].count);
  return term;
}

bool contains(const Model& model, Effect effect) noexcept {
  for (std::size_t i = 0; i < model.count; ++i) {
    if (model.effect[i].effect == effect) return true;
  }
  return false;
}

/// Signs that physics asks for: of the effect's first coefficient, and friction that does not
/// drive.
bool plausible(const Candidate& candidate, const ModelFit& fit, int term) noexcept {
  const double theta = fit.theta[term];
  if (candidate.sign * theta < 0.0) return false;
  if (is_pair(candidate) && candidate.sign * fit.theta[term + 1] < 0.0) return false;
  if (candidate.effect == Effect::kAsymmetricViscous) {
    // c+ and c- : theta_v +- theta_|v|
    return fit.theta[term + 1] > std::abs(theta);
  }
  return true;
}

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

/// Of two forms that explain alike, the plainer one.
double handicap(const Candidate& candidate) noexcept {
  const bool between = is_pair(candidate);
  const bool one_sided = candidate.effect == Effect::kBumpStop && candidate.form != kPlainForm;
  return 1.0 + (between ? 0.01 : 0.0) + (one_sided ? 0.015 : 0.0);
}

constexpr double kGridStd = 0.29;     // of a place known to one step: 1 / sqrt(12)
constexpr double kRowsPerFact = 4.0;  // windows overlap

/// Where the parabola through three errors is least, in steps from the middle one.
double vertex(const std::array<double, 2>& side, double middle) noexcept {
  const double curvature = side[0] + side[1] - 2.0 * middle;
  if (!(side[0] > 0.0 && side[1] > 0.0 && curvature > 0.0)) return 0.0;
  return std::clamp(0.5 * (side[0] - side[1]) / curvature, -0.5, 0.5);
}

constexpr double kSurrogateGains =
    2.0;  // a real effect gains more than so many times the surrogate's

}  // namespace

void Explainer::try_all(const Model& model, const ModelFit& now, BestOfEffects& best) noexcept {
  best = {};
  list_candidates(base_of(now), grids_, candidates_);
  for (std::size_t i = 0; i < candidates_.count; ++i) {
    const Candidate& candidate = candidates_.item[i];
    if (contains(model, candidate.effect)) continue;
    if (!allowed_[static_cast<std::size_t>(candidate.effect)]) continue;
    const ModelFit fit = fitter_.fit(model.with(candidate));
    if (!fit.ok || !plausible(candidate, fit, now.terms)) continue;
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

void Explainer::add_runner_up(const Model& model, const Candidate& candidate, const ModelFit& now,
                              Step& step) noexcept {
  const ModelFit fit = fitter_.fit(model.with(candidate));
  step.runner_up[step.runner_up_count++] = {
      candidate.effect, fit.held_out_nmse, 1.0 - fit.held_out_nmse / now.held_out_nmse,
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
    const int term = first_term(out.model, out.base_count + i);
    for (std::size_t c = 0; c < candidates_.count; ++c) {
      if (!is_of_grid(candidates_.item[c], before)) continue;
      place = candidates_.item[c];
      const ModelFit fit = fitter_.fit(out.model);
      if (!fit.ok || !plausible(place, fit, term)) continue;
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

/// The c-th of the best candidates beside the others.
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
    if (i != c) add_runner_up(model, order[i]->candidate, now, step);
  }
  return step;
}

void Explainer::backward(Explanation& out, ModelFit& now) noexcept {
  for (std::size_t i = 0; out.step_count > 1 && i < out.step_count;) {
    if (out.model.effect[out.base_count + i].count == 0) {
      ++i;
      continue;
    }
    const Model less = out.model.without(out.base_count + i);
    const ModelFit without = fitter_.fit(less);
    if (!without.ok || without.held_out_nmse > (1.0 + kNeeded) * now.held_out_nmse) {
      ++i;
      continue;
    }
    out.model = less;
    for (std::size_t j = i; j + 1 < out.step_count; ++j) out.step[j] = out.step[j + 1];
    --out.step_count;
    now = without;
    i = 0;
  }
}

Explanation Explainer::explain(const GramStore& store, const ImpulseMeter& meter,
                               const Grids& grids, const ExplainerConfig& config) noexcept {
  Explanation out;
  out.grids = grids_ = grids;
  if (store.count() < kFewestEntries || !evidence_.load(store)) return out;
  allowed_ = config.allowed;
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
  if (config.known != nullptr) keep(store, *config.known, out, now);
  while (forward(out, now)) {
    now = settle(store, out.model);
    if (readjust(out, now)) now = settle(store, out.model);
  }
  const bool impulses = allowed_[static_cast<std::size_t>(Effect::kImpulsiveInput)];
  if (out.step_count == 0 && impulses) add_impulses(meter, now, out);
  backward(out, now);
  out.final = settle(store, out.model);
  out.weight = evidence_.weight;
  out.target = evidence_.total.at(kTarget, kTarget);
  for (std::size_t i = 0; i + out.base_count < out.model.count; ++i) {
    refine(out.model, out.base_count + i, out.final, out.step[i]);
  }
  restate(out);
  out.floor_nmse = config.floor_nmse;
  describe(config.moving_mass_kg, out);
  conclude(0, out);
  return out;
}

/// Where the error is least between the grid's points: the vertex of the parabola through it and
/// its neighbours; its deviation from the parabola's curvature.
void Explainer::refine(const Model& model, std::size_t i, const ModelFit& final,
                       Step& step) noexcept {
  const Candidate& chosen = step.chosen;
  step.place = chosen.variant;
  step.place_std = kGridStd;
  if (is_pair(chosen)) {
    const int term = first_term(model, i);
    const double low = std::abs(final.theta[term]);
    const double high = std::abs(final.theta[term + 1]);
    step.place += high / (low + high);
    return;
  }
  list_candidates(base_of(final), grids_, candidates_);
  const std::size_t line = line_of(chosen.effect, chosen.form == kPitchForm, grids_);
  const std::array<double, 2> side = beside(model, i, 1, true);
  step.place += vertex(side, final.nmse);
  step.line_offset = vertex(beside(model, i, static_cast<int>(line), false), final.nmse);
  const double curvature = side[0] + side[1] - 2.0 * final.nmse;
  if (!(side[0] > 0.0 && side[1] > 0.0 && curvature > 0.0)) return;
  const double target = evidence_.total.at(kTarget, kTarget);
  step.place_std = std::clamp(std::sqrt(2.0 * kRowsPerFact / (curvature * target)), 0.05, kGridStd);
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
    if (late) {
      step.held_out_nmse_after = now.held_out_nmse;
      step.gain = 1.0 - step.held_out_nmse_after / step.held_out_nmse_before;
    }
    out.step[out.step_count++] = step;
  }
  out.base = known.base;
  out.base_weight = known.base_weight;
  out.base_target = known.base_target;
}

void Explainer::restate(Explanation& e) noexcept {
  Model model = e.base_model;
  double before = fitter_.fit(model).held_out_nmse;
  e.base_restated_nmse = before;
  for (std::size_t i = 0; i < e.step_count; ++i) {
    Step& step = e.step[i];
    const Candidate& added = e.model.effect[e.base_count + i];
    step.restated_before = step.held_out_nmse_before;
    step.restated_after = step.held_out_nmse_after;
    if (added.count == 0) continue;  // no column, so no other error
    model = model.with(added);
    step.restated_before = before;
    step.restated_after = before = fitter_.fit(model).held_out_nmse;
  }
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
  const double base_floor = mean_of(e.base_weight, e.base_target);
  if (base_floor < 0.0) return false;
  e.base_floor_nmse = base_floor;
  if (!beats_surrogate(surrogates.base, e)) drop_steps(e);
  const Model remembering = remembering_part(e);
  const bool remembers = surrogates.remembering != nullptr && remembering.count > e.base_count;
  const double floor =
      remembers ? left_of_surrogate(*surrogates.remembering, remembering, e.weight, e.target)
                : mean_of(e.weight, e.target);
  if (floor < 0.0) return false;
  e.floor_nmse = floor;
  conclude(impacts, e);
  return true;
}

Estimate Explainer::lateness(const Diagnosis& diagnosis, const Model& model,
                             const Candidate& skew) noexcept {
  if (diagnosis.store().count() < kFewestEntries || !evidence_.load(diagnosis.store())) return {};
  Model with;
  for (std::size_t i = 0; i < model.count; ++i) {
    if (model.effect[i].count > 0) with = with.with(model.effect[i]);
  }
  const int term = first_term(with, with.count);
  with = with.with(skew);
  const ModelFit fit = settle(diagnosis.store(), with);
  if (!fit.ok) return {};
  return {fit.theta[term], std::sqrt(std::max(fit.covariance(term, term), 0.0))};
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

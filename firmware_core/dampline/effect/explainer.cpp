// SPDX-License-Identifier: MIT
#include "dampline/effect/explainer.hpp"

#include <algorithm>
#include <cmath>

#include "dampline/effect/parameters.hpp"
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
    int term = ModelFit::kFirstEffect;
    for (std::size_t e = 0; e < out.base_count + i; ++e)
      term += static_cast<int>(out.model.effect[e].count);
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

}  // namespace dampline::effect

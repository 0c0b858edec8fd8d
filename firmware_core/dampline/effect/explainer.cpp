// SPDX-License-Identifier: MIT
#include "dampline/effect/explainer.hpp"

#include <algorithm>
#include <cmath>

#include "dampline/effect/parameters.hpp"

namespace dampline::effect {
namespace {

constexpr std::size_t kFewestEntries = 10;
constexpr double kClearGain = 0.05;   // passes on its own
constexpr double kSmallGain = 0.025;  // passes with kSignificant
constexpr double kSignificant = 2.0;
constexpr double kLeastGain = 0.003;  // passes with kVerySignificant
constexpr double kVerySignificant = 3.3;
constexpr double kLaterGain = 0.02;         // of a second effect, with kLaterT
constexpr double kLaterMemoryGain = 0.035;  // beside a law with memory
constexpr double kLaterPictureGain = 0.1;
constexpr double kLaterT = 4.0;
constexpr double kLaterClearGain = 0.05;  // with kLaterClearT: stops are seldom reached
constexpr double kLaterClearT = 2.5;
constexpr double kSkewGain = 0.025;  // below, a time skew is no candidate
constexpr double kNeeded = 0.01;     // loss without it that keeps an effect in the model
constexpr double kSimplerWithin = 0.02;
constexpr double kGridStd = 0.29;       // of a place known to one step: 1 / sqrt(12)
constexpr double kRowsPerFact = 4.0;    // windows overlap
constexpr double kImpulseShare = 0.08;  // of the residual's energy in large values
constexpr std::uint64_t kFewestImpulses = 6;
constexpr int kWeightIterations = 3;

bool contains(const Model& model, Effect effect) noexcept {
  for (std::size_t i = 0; i < model.count; ++i) {
    if (model.effect[i].effect == effect) return true;
  }
  return false;
}

double block_t(const ModelFit& before, const ModelFit& after, std::size_t entries) noexcept {
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t e = 0; e < entries; ++e) {
    const double d = before.held_out_error[e] - after.held_out_error[e];
    sum += d;
    squares += d * d;
  }
  const auto n = static_cast<double>(entries);
  const double variance = (squares - sum * sum / n) / (n - 1.0);
  return variance > 0.0 ? sum / std::sqrt(n * variance) : 0.0;
}

/// Two neighbours of a grid.
bool is_pair(const Candidate& candidate) noexcept {
  return candidate.count > 1 && candidate.effect != Effect::kAsymmetricViscous;
}

/// Sensors and modes: each is a first-order picture of what it names, and what it leaves looks like
/// the others.
bool is_picture(Effect effect) noexcept {
  return effect == Effect::kTimeSkew || effect == Effect::kGainError ||
         effect == Effect::kUnmodelledMode;
}
double later_gain(const Model& model, Effect effect) noexcept {
  bool picture = false;
  bool memory = false;
  for (std::size_t i = 0; i < model.count; ++i) {
    const Effect known = model.effect[i].effect;
    picture = picture || is_picture(known);
    memory = memory || known == Effect::kPreslidingHysteresis || known == Effect::kBacklash;
  }
  if (picture && is_picture(effect)) return kLaterPictureGain;
  return memory ? kLaterMemoryGain : kLaterGain;
}

/// What a candidate must bring. The first effect is judged by gain and significance together; small
/// errors of the velocity's phase look like a time skew, so that needs a larger gain; later effects
/// must not be the imperfections of the first.
bool passes(const Step& step, bool first, double later) noexcept {
  if (!first)
    return step.gain > later &&
           (step.block_t > kLaterT || (step.gain > kLaterClearGain && step.block_t > kLaterClearT));
  if (step.gain > kClearGain || (step.gain > kSmallGain && step.block_t > kSignificant))
    return true;
  return step.chosen.effect != Effect::kTimeSkew && step.gain > kLeastGain &&
         step.block_t > kVerySignificant;
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

/// Impacts that no sensor measured are no column: the rows that they reach are told by their size.
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
  list_candidates({now.theta[ModelFit::kCoulomb], now.theta[ModelFit::kStiffness]}, candidates_);
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

ModelFit Explainer::settle(const GramStore& store, const Model& model) noexcept {
  ModelFit fit = fitter_.fit(model);
  for (int i = 0; i < kWeightIterations && fit.ok; ++i) {
    evidence_.weigh(store, fitter_.weights_of(model, fit));
    fit = fitter_.fit(model);
  }
  return fit;
}

void Explainer::add_runner_up(const Model& model, const Candidate& candidate, const ModelFit& now,
                              Step& step) noexcept {
  const ModelFit fit = fitter_.fit(model.with(candidate));
  step.runner_up[step.runner_up_count++] = {candidate.effect, fit.held_out_nmse,
                                            1.0 - fit.held_out_nmse / now.held_out_nmse,
                                            block_t(now, fit, evidence_.count)};
}

bool Explainer::forward(Explanation& out, ModelFit& now) noexcept {
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
  // Of two that explain alike, the one with fewer coefficients.
  std::size_t pick = 0;
  for (std::size_t i = 1; i < found; ++i) {
    const bool simpler = order[pick]->candidate.effect == Effect::kAsymmetricViscous &&
                         order[i]->candidate.count == 1;
    if (simpler && order[i]->held_out_nmse < (1.0 + kSimplerWithin) * order[0]->held_out_nmse) {
      pick = i;
    }
  }
  const Best& chosen = *order[pick];
  const ModelFit fit = fitter_.fit(out.model.with(chosen.candidate));
  Step step;
  step.chosen = chosen.candidate;
  step.held_out_nmse_before = now.held_out_nmse;
  step.held_out_nmse_after = fit.held_out_nmse;
  step.gain = 1.0 - fit.held_out_nmse / now.held_out_nmse;
  step.block_t = block_t(now, fit, evidence_.count);
  for (std::size_t i = 0; i < found && step.runner_up_count < Step::kMostRunnersUp; ++i) {
    if (i != pick) add_runner_up(out.model, order[i]->candidate, now, step);
  }
  out.rejected = step;
  if (!passes(step, out.step_count == 0, later_gain(out.model, step.chosen.effect))) return false;
  out.model = out.model.with(chosen.candidate);
  out.step[out.step_count++] = step;
  out.rejected = {};
  now = fit;
  return true;
}

void Explainer::backward(Explanation& out, ModelFit& now) noexcept {
  for (std::size_t i = 0; out.step_count > 1 && i < out.step_count;) {
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

/// Where the error is least between the grid's points: the vertex of the parabola through it and
/// its neighbours; its deviation from the parabola's curvature.
void Explainer::refine(const Model& model, std::size_t i, const ModelFit& final,
                       Step& step) noexcept {
  const Candidate& chosen = step.chosen;
  step.place = chosen.variant;
  step.place_std = kGridStd;
  if (is_pair(chosen)) {
    int term = ModelFit::kFirstEffect;
    for (std::size_t e = 0; e < i; ++e) term += static_cast<int>(model.effect[e].count);
    const double low = std::abs(final.theta[term]);
    const double high = std::abs(final.theta[term + 1]);
    step.place += high / (low + high);
    return;
  }
  list_candidates({final.theta[ModelFit::kCoulomb], final.theta[ModelFit::kStiffness]},
                  candidates_);
  std::array<double, 2> side{};
  for (std::size_t c = 0; c < candidates_.count; ++c) {
    const Candidate& other = candidates_.item[c];
    if (other.effect != chosen.effect || other.form != chosen.form || other.count != 1) continue;
    const int distance = static_cast<int>(other.variant) - static_cast<int>(chosen.variant);
    if (distance != 1 && distance != -1) continue;
    Model neighbour = model;
    neighbour.effect[i] = other;
    side[distance > 0 ? 1 : 0] = fitter_.fit(neighbour).nmse;
  }
  const double curvature = side[0] + side[1] - 2.0 * final.nmse;
  if (!(side[0] > 0.0 && side[1] > 0.0 && curvature > 0.0)) return;
  step.place += std::clamp(0.5 * (side[0] - side[1]) / curvature, -0.5, 0.5);
  const double target = evidence_.total.at(kTarget, kTarget);
  step.place_std = std::clamp(std::sqrt(2.0 * kRowsPerFact / (curvature * target)), 0.05, kGridStd);
}

Explanation Explainer::explain(const GramStore& store, const ImpulseMeter& meter, double scale_m,
                               const ExplainerConfig& config) noexcept {
  Explanation out;
  if (store.count() < kFewestEntries || !evidence_.load(store)) return out;
  allowed_ = config.allowed;
  if (config.base_viscous) {
    list_candidates({}, candidates_);
    out.model = out.model.with(candidates_.item[0]);
    out.base_count = 1;
  }
  out.base_model = out.model;
  ModelFit now = settle(store, out.model);
  if (!now.ok) return out;
  out.base = now;
  out.base_weight = evidence_.weight;
  out.base_target = evidence_.total.at(kTarget, kTarget);
  while (forward(out, now)) now = settle(store, out.model);
  const bool impulses = allowed_[static_cast<std::size_t>(Effect::kImpulsiveInput)];
  if (out.step_count == 0 && impulses) add_impulses(meter, now, out);
  backward(out, now);
  out.final = settle(store, out.model);
  out.weight = evidence_.weight;
  out.target = evidence_.total.at(kTarget, kTarget);
  for (std::size_t i = 0; i + out.base_count < out.model.count; ++i) {
    refine(out.model, out.base_count + i, out.final, out.step[i]);
  }
  out.floor_nmse = config.floor_nmse;
  describe(config.moving_mass_kg, scale_m, out);
  conclude(0, out);
  return out;
}

}  // namespace dampline::effect

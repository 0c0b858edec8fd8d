// SPDX-License-Identifier: MIT
// What the explainer makes of records that it did not explain: predicted ones, and the twin.
#include <algorithm>
#include <cmath>

#include "dampline/effect/explainer.hpp"

namespace dampline::effect {
namespace {

constexpr std::size_t kFewestEntries = 10;
constexpr double kTwinGains = 2.0;  // a real effect gains more than so many times the twin's

}  // namespace

Explainer::Prediction Explainer::predict(const Diagnosis& other, const Explanation& by) noexcept {
  if (other.store().count() == 0 || !evidence_.load(other.store())) return {};
  evidence_.weigh(other.store(), by.weight);
  return {fitter_.nmse_of(by.base_model, by.base), fitter_.nmse_of(by.model, by.final)};
}

double Explainer::left_of_twin(const Diagnosis& twin, const Model& model,
                               const ScaleWeights& weights, double target) noexcept {
  if (twin.store().count() < kFewestEntries || !evidence_.load(twin.store())) return -1.0;
  evidence_.weigh(twin.store(), weights);
  const ModelFit fit = fitter_.fit(model);
  return fit.ok ? fit.held_out_nmse * evidence_.total.at(kTarget, kTarget) / target : -1.0;
}

bool Explainer::apply_floor(const Twins& twins, std::uint64_t impacts, Explanation& e) noexcept {
  const auto mean_of = [&](const ScaleWeights& weights, double target) {
    const double first = left_of_twin(twins.base, e.base_model, weights, target);
    if (twins.other_noise == nullptr || first < 0.0) return first;
    const double second = left_of_twin(*twins.other_noise, e.base_model, weights, target);
    return second < 0.0 ? second : 0.5 * (first + second);
  };
  const double base_floor = mean_of(e.base_weight, e.base_target);
  if (base_floor < 0.0) return false;
  e.base_floor_nmse = base_floor;
  if (!beats_twin(twins.base, e)) drop_steps(e);
  const Model remembering = remembering_part(e);
  const bool remembers = twins.remembering != nullptr && remembering.count > e.base_count;
  const double floor = remembers ? left_of_twin(*twins.remembering, remembering, e.weight, e.target)
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
  int term = ModelFit::kFirstEffect;
  for (std::size_t i = 0; i < with.count; ++i) term += static_cast<int>(with.effect[i].count);
  with = with.with(skew);
  const ModelFit fit = settle(diagnosis.store(), with);
  if (!fit.ok) return {};
  return {fit.theta[term], std::sqrt(std::max(fit.covariance(term, term), 0.0))};
}

/// Large residuals, too, are rare in time on a twin without impacts: those of sticking.
bool Explainer::beats_twin(const Diagnosis& twin, const Explanation& e) noexcept {
  if (e.step_count == 0) return true;
  double gain = twin.impulses().share();
  if (e.step[0].chosen.count > 0) {
    const double without = left_of_twin(twin, e.base_model, e.base_weight, e.base_target);
    const double with =
        left_of_twin(twin, e.base_model.with(e.step[0].chosen), e.base_weight, e.base_target);
    gain = with < 0.0 ? 0.0 : 1.0 - with / without;
  }
  return e.step[0].gain >= kTwinGains * gain;
}

}  // namespace dampline::effect

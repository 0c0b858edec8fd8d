// SPDX-License-Identifier: MIT
// What the explainer makes of records that it did not explain: predicted ones, and the twin.
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

bool Explainer::apply_floor(const Diagnosis& twin, std::uint64_t impacts, Explanation& e) noexcept {
  const GramStore& store = twin.store();
  if (store.count() < kFewestEntries || !evidence_.load(store)) return false;
  // Errors of the twin as shares of the record's own sum of squares.
  const auto left = [&](const ModelFit& fit, double target) {
    return fit.held_out_nmse * evidence_.total.at(kTarget, kTarget) / target;
  };
  evidence_.weigh(store, e.base_weight);
  const ModelFit base = fitter_.fit(e.base_model);
  if (!base.ok) return false;
  e.base_floor_nmse = left(base, e.base_target);
  const bool has_columns = e.step_count > 0 && e.step[0].chosen.count > 0;
  if (has_columns) {
    const ModelFit with = fitter_.fit(e.base_model.with(e.step[0].chosen));
    const double gain = with.ok ? 1.0 - with.held_out_nmse / base.held_out_nmse : 0.0;
    if (e.step[0].gain < kTwinGains * gain) drop_steps(e);
  } else if (e.step_count > 0 && e.step[0].gain < kTwinGains * twin.impulses().share()) {
    drop_steps(e);  // large residuals are rare in time on the twin too: those of sticking
  }
  evidence_.weigh(store, e.weight);
  const ModelFit final = fitter_.fit(e.base_model);
  if (!final.ok) return false;
  e.floor_nmse = left(final, e.target);
  conclude(impacts, e);
  return true;
}

}  // namespace dampline::effect

// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "app/explain/rig/rig_rank.hpp"
#include "app/explain/rig/rig_search.hpp"

namespace dampline::app {
namespace {

constexpr double kLeastGain = 0.1;
constexpr double kSignificant = 3.0;
constexpr double kBetter = 0.85;      // of what the best column leaves
constexpr double kStepPlace = 0.029;  // of the record: a tenth, evenly spread

}  // namespace

RigTrialBase RigSearch::trial_base() const {
  RigTrialBase out;
  const ColumnSet more = joined(chosen_columns(), {library_.spring, library_.offset});
  const bool sign = library_.base_friction && base_friction_left_;
  for (const Eigen::Index i : set_of(more, 0))
    if (!sign || i != library_.friction[0])
      out.columns.push_back(library_.columns[static_cast<std::size_t>(i)]);
  if (sign)
    for (const Eigen::Index i : library_.friction)
      out.friction.push_back(library_.columns[static_cast<std::size_t>(i)]);
  out.ridge = ridge();
  return out;
}

std::optional<RigTrial> RigSearch::best_trial() const {
  const auto is_taken = [&](const char* effect) {
    return std::any_of(chosen_.begin(), chosen_.end(),
                       [&](const Chosen& c) { return c.step.effect == effect; });
  };
  const RigTrialBase base = trial_base();
  std::optional<RigTrial> best;
  if (library_.wants_skew && !is_taken("time_skew")) best = try_skew(records_, base);
  std::optional<RigTrial> drift;
  if (library_.wants_drift && !is_taken("time_drift")) drift = try_drift(records_, base);
  if (drift && (!best || drift->gain > best->gain)) best = drift;
  return best;
}

/// Clearly better than every column: many things look a little like a delay.
bool RigSearch::is_better(const RigTrial& trial, const std::vector<Ranked>& order) const {
  if (trial.gain < kLeastGain || trial.t < kSignificant) return false;
  const RigFit& other = order.front().fit;
  return trial.fit.held_out_nmse < kBetter * other.held_out_nmse &&
         block_t(other, trial.fit) > kSignificant;
}

void RigSearch::take(const RigTrial& trial, double before) {
  Chosen chosen;
  chosen.candidate.effect = trial.effect;
  for (const RigColumn& c : trial.columns) chosen.candidate.columns.push_back(library_.add(c));
  chosen.skew_s = trial.skew_s;
  chosen.step.effect = trial.effect;
  chosen.step.held_out_before = before;
  chosen.step.gain = trial.gain;
  chosen.step.block_t = trial.t;
  chosen.step.runners_up = rejected_;
  rejected_.clear();
  if (trial.effect == "time_skew") {
    chosen.step.parameters.push_back({"time_skew", 1e3 * trial.skew_s,
                                      1e3 * skew_deviation(records_, trial_base(), trial.skew_s),
                                      "ms"});
    for (RigSeries& record : records_) record = delayed(record, trial.skew_s);
  } else {
    chosen.step.parameters.push_back({"time_drift_" + trial.parameter, 0.0, 0.0, "%"});
    if (trial.at_share > 0.0) {
      const RigSeries& r = records_.front();
      const double length_s = r.time_s[r.size() - 1] - r.time_s[0];
      chosen.step.parameters.push_back(
          {"time_drift_time", r.time_s[0] + trial.at_share * length_s, kStepPlace * length_s, "s"});
    }
  }
  chosen_.push_back(chosen);
  evidence_ = std::make_unique<RigEvidence>(library_.columns, records_);
  chosen_.back().step.held_out_after = judge(chosen_columns()).fit.held_out_nmse;
  chosen_.back().step.terms = terms();
}

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <utility>

#include "app/explain/rig/rig_impacts.hpp"
#include "app/explain/rig/rig_rank.hpp"
#include "app/explain/rig/rig_search.hpp"

namespace dampline::app {
namespace {

constexpr double kLeastGain = 0.1;
constexpr double kSignificant = 3.0;
constexpr double kClearMemory = 0.2;
constexpr double kBetter = 0.85;  // of what the best column leaves
constexpr double kResolved = 0.03;
constexpr double kStepPlace = 0.029;  // of the record: a tenth, evenly spread

/// Whether a derivative over one sample differs little from one over two: otherwise what a skew
/// would be is an error of the velocity.
bool is_resolved(const RigSeries& record) {
  const Eigen::VectorXd& x = record.deflection_m;
  double curved = 0.0;
  double steps = 0.0;
  for (Eigen::Index i = 2; i + 2 < x.size(); ++i) {
    const double third = x[i + 2] - 2.0 * x[i + 1] + 2.0 * x[i - 1] - x[i - 2];
    curved += third * third / 144.0 - 10.0 / 144.0 * record.noise_m * record.noise_m;
    steps += 0.25 * (x[i + 1] - x[i - 1]) * (x[i + 1] - x[i - 1]);
  }
  return record.config.velocity_measured || curved < kResolved * kResolved * steps;
}

}  // namespace

/// Impacts come first: they are in every column's way. What is judged later is judged without the
/// moments about them.
void RigSearch::leave_impacts_out() {
  const Judged before = judge({});
  const Judged rough = judge(joined({}, {library_.spring, library_.offset}));
  if (!before.fit.ok || !rough.fit.ok || filtered()) return;
  const double floor = floor_of({library_.spring, library_.offset}).nmse;
  if (rough.fit.held_out_nmse < RigExplanation::kIncompleteAbove * floor) return;
  // What takes up a play, or builds up anew, may do it with a jerk.
  const std::vector<Ranked> order = rank();
  if (!order.empty() && is_memory(order.front().candidate->effect) &&
      order.front().gain > kClearMemory)
    return;
  const std::vector<RigColumn> columns =
      columns_of(set_of({library_.spring, library_.offset}, rough.width));
  std::vector<Eigen::VectorXd> left_n;
  for (const RigSeries& record : records_) {
    left_n.push_back(record.force_n);
    for (std::size_t c = 0; c < columns.size(); ++c)
      left_n.back() -= rough.fit.theta[static_cast<Eigen::Index>(c)] * evaluate(columns[c], record);
  }
  const RigImpacts impacts = find_impacts(records_, left_n);
  if (!impacts.found()) return;
  std::vector<RigSeries> kept = records_;
  for (std::size_t r = 0; r < kept.size(); ++r) kept[r].left_out = impacts.left_out[r];
  std::swap(records_, kept);
  auto all = std::move(evidence_);
  evidence_ = std::make_unique<RigEvidence>(library_.columns, records_);
  const Judged after = judge({});
  Chosen chosen;
  chosen.step.gain = 1.0 - after.fit.held_out_nmse / before.fit.held_out_nmse;
  chosen.step.block_t = block_t(before.fit, after.fit);
  if (!after.fit.ok || chosen.step.gain < kLeastGain) {
    std::swap(records_, kept);
    evidence_ = std::move(all);
    return;
  }
  chosen.candidate.effect = chosen.step.effect = "impulsive_input";
  chosen.step.held_out_before = before.fit.held_out_nmse;
  chosen.step.held_out_after = after.fit.held_out_nmse;
  const auto count = static_cast<double>(impacts.peak_n.size());
  double mean = 0.0;
  double squares = 0.0;
  for (const double p : impacts.peak_n) mean += p / count;
  for (const double p : impacts.peak_n) squares += (p - mean) * (p - mean);
  chosen.step.parameters = {
      {"impulsive_input_count", count, std::sqrt(count), ""},
      {"impulsive_input_force", mean, std::sqrt(squares / (count * (count - 1.0))), "N"}};
  chosen_.push_back(chosen);
  chosen_.back().step.terms = terms();
}

RigTrialBase RigSearch::trial_base() const {
  RigTrialBase out;
  const ColumnSet more = joined(chosen_columns(), {library_.spring, library_.offset});
  const bool sign = library_.base_friction && base_friction_left_;
  ColumnSet set = set_of(more, 0);
  if (sign) {
    std::erase(set, library_.friction[0]);
    out.friction = columns_of(library_.friction);
  }
  out.columns = columns_of(set);
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
  const bool resolved = std::all_of(records_.begin(), records_.end(), is_resolved);
  if (library_.wants_skew && resolved && !is_taken("time_skew")) best = try_skew(records_, base);
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

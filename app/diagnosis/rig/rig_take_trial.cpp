// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/diagnosis/rig/rig_impacts.hpp"
#include "app/diagnosis/rig/rig_rank.hpp"
#include "app/diagnosis/rig/rig_search.hpp"

namespace dampline::app {
namespace {

constexpr double kLeastGain = 0.1;
constexpr double kSignificant = 3.0;
constexpr double kClearMemory = 0.2;
constexpr double kBetter = 0.85;  // of what the best column leaves
constexpr double kOverFloor = 1.1;
constexpr double kMemoryToo = 0.5;
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

bool is_clearly_better(const RigFit& fit, const RigFit& other) {
  return fit.held_out_nmse < kBetter * other.held_out_nmse && block_t(other, fit) > kSignificant;
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
  left_n.reserve(records_.size());
  for (const RigSeries& record : records_)
    left_n.push_back(left_of(record, columns, rough.fit.theta));
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

/// Clearly better than what is simpler.
void RigSearch::prefer_mode(std::optional<RigTrial>& best) const {
  const RigTrialBase base = trial_base();
  for (const auto& mode : {try_attached(records_, base), try_path(records_, base)}) {
    if (!mode) continue;
    if (!best || is_clearly_better(mode->fit, best->fit)) best = mode;
  }
}

std::optional<RigTrial> RigSearch::best_trial(double before_nmse) const {
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
  if (!library_.wants_mode || is_taken("unmodelled_mode")) return best;
  const double floor = floor_of(joined(chosen_columns(), {library_.spring, library_.offset})).nmse;
  if (before_nmse > kOverFloor * floor) prefer_mode(best);
  return best;
}

/// Clearly better than every column: many things look a little like a delay.
bool RigSearch::is_better(const RigTrial& trial, const std::vector<Ranked>& order) const {
  if (trial.gain < kLeastGain || trial.t < kSignificant) return false;
  if (!is_clearly_better(trial.fit, order.front().fit)) return false;
  // What memory rounds, a delay or a mode rounds too: its smallest form is too rough to tell.
  const bool memory = std::any_of(order.begin(), order.end(), [&](const Ranked& r) {
    return is_memory(r.candidate->effect) && r.gain > kMemoryToo * trial.gain;
  });
  if (!memory) return true;
  const auto smooth = best_bouc_wen(records_, trial_base(), scale_.deflection_m);
  return !smooth || trial.fit.held_out_nmse < kBetter * smooth->fit.held_out_nmse;
}

/// An inertia force is no effect that a damper lacks: effects are looked for beside it. A late
/// force is one of a negative mass, an early one may be meant by a positive one.
bool RigSearch::take_mass(const std::vector<Ranked>& order, const std::optional<RigTrial>& trial) {
  if (filtered() || mass_added_) return false;
  const ColumnSet both = joined(chosen_columns(), {library_.spring, library_.offset});
  const RigCandidate mass{"moving_mass", 0.0, {library_.mass}, 1};
  const Judged without = judge(both);
  const Judged with = judge(joined(both, mass.columns));
  if (!without.fit.ok || !with.fit.ok) return false;
  const ColumnSet set = set_of(joined(both, mass.columns), with.width);
  const Eigen::Index at = place_of(set, library_.mass);
  if (!(with.fit.theta[at] > 0.0)) return false;
  RigTrial as_trial;
  as_trial.fit = with.fit;
  as_trial.gain = 1.0 - with.fit.held_out_nmse / without.fit.held_out_nmse;
  as_trial.t = block_t(without.fit, with.fit);
  if (!is_better(as_trial, order)) return false;
  if (trial && trial->effect == "time_skew" && !is_clearly_better(with.fit, trial->fit))
    return false;
  if (trial && is_clearly_better(trial->fit, with.fit)) return false;
  if (!passes({&mass, as_trial.gain, as_trial.t, with.fit, false}, without.fit.held_out_nmse))
    return false;
  mass_added_ = true;
  notes_.push_back(fmt::format(
      "An inertia force of {:.4g} kg, which the base model does not have, was added first: "
      "held-out rrse {:.3f} -> {:.3f}. A mass on a spring whose resonance lies far above the "
      "motion looks the same. To have it in the base: [model] inertia = \"identify\"",
      with.fit.theta[at], std::sqrt(without.fit.held_out_nmse), std::sqrt(with.fit.held_out_nmse)));
  return true;
}

void RigSearch::take_mode(const RigTrial& trial, Chosen& chosen) {
  const RigMode std = mode_deviation(records_, trial_base(), trial);
  chosen.step.parameters = {{"unmodelled_mode_frequency", trial.mode.hz, std.hz, "Hz"},
                            {"unmodelled_mode_damping", trial.mode.damping, std.damping, ""}};
  if (!trial.columns.empty()) return;
  chosen.path = trial.mode;
  for (RigSeries& record : records_) record.path = trial.mode;
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
  } else if (trial.effect == "unmodelled_mode") {
    take_mode(trial, chosen);
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

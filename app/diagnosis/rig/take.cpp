// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/diagnosis/rig/memory_change.hpp"
#include "app/diagnosis/rig/remainder.hpp"
#include "app/diagnosis/rig/steps.hpp"
#include "app/diagnosis/rig/thresholds.hpp"

namespace dampline::app::rig {
namespace {

/// Whether a derivative over one sample differs little from one over two: otherwise what a skew
/// would be is an error of the velocity.
bool is_resolved(const Series& record) {
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

/// Clearly better than what is simpler.
void prefer_mode(const State& s, std::optional<Trial>& best) {
  const TrialBase base = trial_base(s);
  for (const auto& mode : {try_attached(s.records, base), try_path(s.records, base)}) {
    if (!mode) continue;
    if (!best || is_clearly_better(mode->fit, best->fit)) best = mode;
  }
}

/// What changes, and when; the rest is known when everything is.
std::vector<Parameter> parameters_of(const State& s, const Trial& trial) {
  if (trial.effect != "time_drift") return {};
  std::vector<Parameter> out{{"time_drift_" + trial.parameter, 0.0, 0.0, "%"}};
  if (trial.at_share > 0.0) {
    const Series& r = s.records.front();
    const double length_s = r.time_s[r.size() - 1] - r.time_s[0];
    out.push_back(
        {"time_drift_time", r.time_s[0] + trial.at_share * length_s, kStepPlace * length_s, "s"});
  }
  return out;
}

}  // namespace

void leave_impacts_out(State& s) {
  const Judged before = judge(s, {});
  const Judged rough = judge(s, {s.library.spring, s.library.offset});
  if (!before.fit.ok || !rough.fit.ok || filtered(s)) return;
  const double floor = floor_of(s, {s.library.spring, s.library.offset}).nmse;
  if (rough.fit.held_out_nmse < kIncompleteAbove * floor) return;
  // What takes up a play, or builds up anew, may do it with a jerk.
  const std::vector<Ranked> order = rank(s);
  if (!order.empty() && is_memory(order.front().candidate->effect) &&
      order.front().gain > kClearMemory)
    return;
  const std::vector<Regressor> columns = columns_of(s, rough.set);
  std::vector<Eigen::VectorXd> left_n;
  left_n.reserve(s.records.size());
  for (const Series& record : s.records)
    left_n.push_back(left_of(record, columns, rough.fit.theta));
  const Impacts impacts = find_impacts(s.records, left_n);
  if (!impacts.found()) return;
  std::vector<Series> kept = s.records;
  for (std::size_t r = 0; r < kept.size(); ++r) kept[r].left_out = impacts.left_out[r];
  std::swap(s.records, kept);
  const auto all = s.evaluated;
  evaluate_columns(s);
  const Fit after = judge(s, {}).fit;
  const double gain = gain_of(before.fit, after);
  if (!after.ok || gain < kLeastGain) {
    std::swap(s.records, kept);
    s.evaluated = all;
    return;
  }
  choose(s, {"impulsive_input", 0.0, {}, 0}, gain, block_t(before.fit, after));
  const auto count = static_cast<double>(impacts.peak_n.size());
  double mean = 0.0;
  double squares = 0.0;
  for (const double p : impacts.peak_n) mean += p / count;
  for (const double p : impacts.peak_n) squares += (p - mean) * (p - mean);
  s.chosen.back().before = std::move(kept);
  s.chosen.back().step.parameters = {
      {"impulsive_input_count", count, std::sqrt(count), ""},
      {"impulsive_input_force", mean, std::sqrt(squares / (count * (count - 1.0))), "N"}};
}

std::optional<Trial> best_trial(const State& s, double before_nmse) {
  const auto is_taken = [&](const char* effect) {
    return std::any_of(s.chosen.begin(), s.chosen.end(),
                       [&](const Chosen& c) { return c.step.effect == effect; });
  };
  const TrialBase base = trial_base(s);
  std::optional<Trial> best;
  const bool resolved = std::all_of(s.records.begin(), s.records.end(), is_resolved);
  if (s.library.wants_skew && resolved && !is_taken("time_skew")) best = try_skew(s.records, base);
  std::optional<Trial> drift;
  if (s.library.wants_drift && !is_taken("time_drift")) drift = try_drift(s.records, base);
  if (drift && (!best || drift->gain > best->gain)) best = drift;
  if (!s.library.wants_mode || is_taken("unmodelled_mode")) return best;
  const double floor = floor_of(s, beside_both(s)).nmse;
  if (before_nmse > kOverFloor * floor) prefer_mode(s, best);
  return best;
}

bool take_mass(State& s, const std::vector<Ranked>& order, const std::optional<Trial>& trial) {
  if (filtered(s) || s.mass_added) return false;
  const Candidate mass{"moving_mass", 0.0, {s.library.mass}, 1};
  const Fit without = judge(s, beside_both(s)).fit;
  const Judged judged = judge(s, beside_both(s, mass.columns));
  const Fit& with = judged.fit;
  if (!without.ok || !with.ok) return false;
  const double mass_kg = judged.of(s.library.mass).value;
  if (!(mass_kg > 0.0)) return false;
  Trial as_trial;
  as_trial.judge(without, with);
  if (!is_better(s, as_trial, order)) return false;
  if (trial && trial->effect == "time_skew" && !is_clearly_better(with, trial->fit)) return false;
  if (trial && is_clearly_better(trial->fit, with)) return false;
  if (!passes(s, {&mass, as_trial.gain, as_trial.t, with, false}, without.held_out_nmse))
    return false;
  s.mass_added = true;
  s.notes.push_back(fmt::format(
      "An inertia force of {:.4g} kg, which the base model does not have, was added first: "
      "held-out rrse {:.3f} -> {:.3f}. A mass on a spring whose resonance lies far above the "
      "motion looks the same. To have it in the base: [model] inertia = \"identify\"",
      mass_kg, std::sqrt(without.held_out_nmse), std::sqrt(with.held_out_nmse)));
  return true;
}

namespace {

bool is_drift(const Chosen& c) { return c.step.effect == "time_drift"; }

/// What stands beside a memory: all but that and changes over the record.
std::vector<Regressor> beside_memory(const State& s, const Judged& now) {
  ColumnSet set = joined(s.library.base, {s.library.spring, s.library.offset, s.library.viscous});
  if (s.mass_added) set = joined(set, {s.library.mass});
  if (s.library.base_friction) set = joined(set, {s.library.friction[now.width]});
  for (const Chosen& c : s.chosen)
    if (!is_memory(c.step.effect) && !is_drift(c)) set = joined(set, c.candidate.columns);
  return columns_of(s, set);
}

/// What the longer part of a record that changes has: the plainest forms hardly tell.
std::string memory_of_part(const State& s, double at_share) {
  State part = s;
  const Series& record = s.records.front();
  const auto at = static_cast<Eigen::Index>(at_share * static_cast<double>(record.size()));
  const bool tail = at_share < 0.5;
  part.records = {record.part(tail ? at : 0, tail ? record.size() - at : at)};
  part.chosen.clear();
  part.bank.clear();
  part.bouc_wen.reset();
  part.base_friction_left = true;
  evaluate_columns(part);
  for (const Ranked& ranked : rank(part)) {
    if (!is_memory(ranked.candidate->effect)) continue;
    choose(part, Candidate{*ranked.candidate}, 0.0, 0.0);
    refine_memory(part, part.chosen.back());
    return part.chosen.back().step.effect;
  }
  return {};
}

}  // namespace

void take_change_of_memory(State& s) {
  const auto memory = std::find_if(s.chosen.begin(), s.chosen.end(),
                                   [](const Chosen& c) { return is_memory(c.step.effect); });
  if (memory == s.chosen.end() || memory->of_base || !s.library.wants_drift) return;
  if (filtered(s) || s.records.size() > 1) return;
  const Judged now = judge_chosen(s);
  State steady = s;
  std::erase_if(steady.chosen, is_drift);
  auto change = change_of_memory(s.library, beside_memory(s, now), s.records.front(),
                                 judge_chosen(steady).fit);
  if (!change || change->fit.held_out_nmse > (1.0 + kAlikeMost) * now.fit.held_out_nmse) return;
  const std::string name = memory_of_part(s, change->at_share);
  if (!name.empty()) change->effect = name;
  if (!s.bouc_wen) memory->step.effect = memory->candidate.effect = change->effect;
  std::erase_if(s.chosen, is_drift);
  choose(s, {"time_drift", 0.0, {}, 0}, 0.0, block_t(now.fit, change->fit));
  constexpr double kTravelPlace = 0.13;  // between the travels that are tried, evenly spread
  const Series& r = s.records.front();
  const double length_s = r.time_s[r.size() - 1] - r.time_s[0];
  s.chosen.back().step.parameters = {
      {fmt::format("time_drift_{}_travel", change->effect),
       2.0 * (change->after_m - change->before_m),
       2.0 * kTravelPlace * std::hypot(change->before_m, change->after_m), "m"},
      {"time_drift_time", r.time_s[0] + change->at_share * length_s, kStepPlace * length_s, "s"}};
  s.notes.push_back(fmt::format(
      "{} in its plainest form, with a travel of {:.3g} mm before {:.4g} s and {:.3g} mm after, "
      "leaves an rrse of {:.3f}: less than a law that does not change. The law that stands here is "
      "one for the whole record, a mean of both.",
      change->effect, 2e3 * change->before_m, s.chosen.back().step.parameters[1].value,
      2e3 * change->after_m, std::sqrt(change->fit.held_out_nmse)));
}

void take(State& s, const Trial& trial) {
  std::vector<Parameter> parameters = parameters_of(s, trial);
  Candidate candidate{trial.effect, 0.0, {}, 0};
  for (const Regressor& c : trial.columns) candidate.columns.push_back(s.library.add(c));
  choose(s, std::move(candidate), trial.gain, trial.t);
  Chosen& chosen = s.chosen.back();
  chosen.skew_s = trial.skew_s;
  chosen.step.parameters = std::move(parameters);
  chosen.changes = trial.changes;
  chosen.runners_up = std::exchange(s.losers, {});
  s.rejected.clear();
  if (trial.columns.empty()) chosen.path = trial.mode;
  if (trial.skew_s != 0.0 || chosen.path.hz > 0.0) chosen.before = s.records;
  for (Series& record : s.records) {
    if (trial.skew_s != 0.0) record = delayed(record, trial.skew_s);
    if (chosen.path.hz > 0.0) record.path = chosen.path;
  }
  evaluate_columns(s);
}

}  // namespace dampline::app::rig

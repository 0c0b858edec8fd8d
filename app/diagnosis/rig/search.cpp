// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "app/diagnosis/rig/by_motion.hpp"
#include "app/diagnosis/rig/describe.hpp"
#include "app/diagnosis/rig/joint.hpp"
#include "app/diagnosis/rig/law.hpp"
#include "app/diagnosis/rig/remainder.hpp"
#include "app/diagnosis/rig/steps.hpp"
#include "app/diagnosis/rig/strokes.hpp"
#include "app/diagnosis/rig/thresholds.hpp"
#include "app/error.hpp"

namespace dampline::app::rig {
namespace {

void keep_rejected(State& s, const std::vector<Ranked>& order) {
  s.rejected.clear();
  s.losers.clear();
  for (std::size_t i = 0; i < order.size() && i <= kRunnersUp; ++i) {
    s.rejected.push_back(
        {order[i].candidate->effect, order[i].fit.held_out_nmse, order[i].gain, order[i].t});
    if (i > 0) s.losers.push_back(*order[i].candidate);
  }
}

/// An effect that the base has, in the form that leaves least.
void take_of_base(State& s, const std::string& effect) {
  const Candidate* best = nullptr;
  Fit least;
  for (const Candidate& c : s.library.candidates) {
    if (c.effect != effect) continue;
    Fit fit = judge(s, joined(chosen_columns(s), c.columns)).fit;
    if (!fit.beats(least)) continue;
    least = std::move(fit);
    best = &c;
  }
  if (best == nullptr)
    throw RunError{fmt::format(
        "[model] base: {} cannot be told from this motion; expected another base, or a record with "
        "more motion",
        effect)};
  choose(s, Candidate{*best}, 0.0, 0.0);
  Chosen& chosen = s.chosen.back();
  chosen.of_base = true;
  if (!is_memory(effect)) return;
  refine_memory(s, chosen);
  chosen.step.effect = chosen.candidate.effect = effect;
}

/// Takes the first of an order.
void take_first(State& s, const std::vector<Ranked>& order) {
  const Ranked& top = order.front();
  choose(s, *top.candidate, top.gain, top.t);
  Chosen& chosen = s.chosen.back();
  chosen.runners_up = std::exchange(s.losers, {});
  chosen.other_memory = other_memory_of(order);
  s.rejected.clear();
  if (!filtered(s)) try_mass(s);
  if (!is_memory(chosen.step.effect) || s.followed) return;
  refine_memory(s, chosen);
}

/// One more step; false where nothing passes.
bool forward(State& s) {
  if (s.followed) return false;
  std::vector<Ranked> order = rank(s);
  if (order.empty()) return false;
  if (const ByMotion by_motion = prefer_what_moves(s, order); by_motion != ByMotion::kUnknown) {
    keep_rejected(s, order);
    if (by_motion == ByMotion::kFirst) take_first(s, order);
    return by_motion == ByMotion::kFirst;
  }
  const auto left_before = [](const auto& ranked) {
    return ranked.fit.held_out_nmse / (1.0 - ranked.gain);
  };
  prefer_to_offset(s, order);
  if (passes(s, order.front(), left_before(order.front()))) prefer_beside_another(s, order);
  prefer_memory(s, order);
  const Ranked top = order.front();
  keep_rejected(s, order);
  const std::optional<Trial> trial = best_trial(s, left_before(top));
  if (take_mass(s, order, trial)) return true;
  if (trial && is_better(s, *trial, order)) {
    const Candidate no_column;
    const Ranked as_ranked{&no_column, trial->gain, trial->t, trial->fit,
                           std::abs(trial->skew_s) < kShortSkew * s.records.front().interval_s};
    if (passes(s, as_ranked, left_before(*trial))) {
      take(s, *trial);
      return true;
    }
  }
  if (!passes(s, top, left_before(top))) return false;
  s.alike = alike(s, order);
  if (s.alike.empty()) s.alike = prefer_viscoelastic(s, order);
  if (!s.alike.empty()) return false;
  take_first(s, order);
  return true;
}

/// The records as they were before any step from the `count`-th on had changed them.
const std::vector<Series>& records_at(const State& s, std::size_t count) {
  for (std::size_t i = count; i < s.chosen.size(); ++i)
    if (!s.chosen[i].before.empty()) return s.chosen[i].before;
  return s.records;
}

/// Columns of the base and of the first `count` that were chosen, but for its friction. `stepped`:
/// with the linear terms that come with the first step.
ColumnSet set_with(const State& s, std::size_t count, bool stepped) {
  ColumnSet set = s.library.base;
  if (s.spring_added && (stepped || s.base_takes_spring)) set = joined(set, {s.library.spring});
  if (s.mass_added && (stepped || s.base_takes_mass)) set = joined(set, {s.library.mass});
  for (std::size_t i = 0; i < count; ++i) set = joined(set, s.chosen[i].candidate.columns);
  return set;
}

/// The base and the first `count` that were chosen.
TrialBase base_with(const State& s, std::size_t count, bool stepped) {
  TrialBase out;
  bool memory = false;
  for (std::size_t i = 0; i < count; ++i) {
    out.ridge = std::max(out.ridge, s.chosen[i].ridge);
    memory = memory || is_memory(s.chosen[i].candidate.effect);
  }
  out.columns = columns_of(s, set_with(s, count, stepped));
  if (s.library.base_friction && (s.base_friction_left || !memory))
    out.friction = columns_of(s, s.library.friction);
  return out;
}
TrialBase base_with(const State& s, std::size_t count) { return base_with(s, count, count > 0); }

/// Whether a linear term stands above zero in the base alone, too; otherwise it comes with the
/// first step.
bool holds_in_base(const State& s, Eigen::Index column) {
  const std::vector<Series>& records = records_at(s, 0);
  const TrialBase base = base_with(s, count_of_base(s));
  const TrialFits fits{records, base, {s.library.at(column)}};
  const Fit with = fits.best({0});
  return with.beats(fits.best()) &&
         with.theta[static_cast<Eigen::Index>(base.columns.size())] > 0.0;
}

/// The base with what was added to it that is no step.
Model base_model(const State& s, std::vector<std::string>& notes) {
  const std::size_t count = count_of_base(s);
  const TrialBase base = base_with(s, count);
  std::vector<Series> records = records_at(s, 0);
  std::vector<Chosen> chosen{s.chosen.begin(),
                             s.chosen.begin() + static_cast<std::ptrdiff_t>(count)};
  Model out;
  out.terms = s.library.base_terms;
  for (const Chosen& c : chosen) out.terms.push_back(c.step.effect);
  if (s.spring_added && s.base_takes_spring) out.terms.emplace_back("linear spring");
  if (s.mass_added && s.base_takes_mass) out.terms.emplace_back("moving mass");
  ColumnSet set = set_with(s, count, count > 0);
  if (const auto friction = TrialFits{records, base}.friction()) {
    out.columns.push_back(*friction);
    out.friction = 0;
    set.insert(set.begin(), -1);  // no column of the library
  }
  out.columns.insert(out.columns.end(), base.columns.begin(), base.columns.end());
  const Joint joint = fit_jointly(out, records, base.ridge, s.scale);
  describe(s, joint, out, chosen, set, notes);
  return out;
}

/// A change of the friction over the record, where friction has a memory or a width of its own.
void take_change(State& s, const Model& model) {
  const auto drifts = [](const Chosen& c) { return c.step.effect == "time_drift"; };
  if (!s.library.wants_drift || std::any_of(s.chosen.begin(), s.chosen.end(), drifts)) return;
  const std::optional<Trial> trial =
      remembers(s) ? try_change(model, s.records, ridge(s)) : std::nullopt;
  if (trial && trial->gain > kLeastGain && trial->t > kTrialSignificant) return take(s, *trial);
  const std::optional<StrokeChange> change = change_of_strokes(s.records, model);
  if (!change) return;
  choose(s, {"time_drift", 0.0, {}, 0}, 0.0, change->spread / kStrokesDiffer);
  s.chosen.back().step.parameters = {
      {change->side > 0 ? "time_drift_coulomb_positive" : "time_drift_coulomb_negative",
       100.0 * change->range.value, 100.0 * change->range.std, "%"}};
  s.notes.push_back(
      fmt::format("The force of {} like strokes changes over the record by {:.0f} % from the least "
                  "to the most, "
                  "neighbours being alike: a parameter that changes.",
                  change->strokes, 100.0 * change->range.value));
}

/// The final model, its places where they leave least; the library follows.
Model final_model(State& s, ColumnSet& set, std::vector<std::string>& notes) {
  const Judged judged = judge_chosen(s);
  Model out;
  set = judged.set;
  if (!judged.fit.ok) return out;
  out.columns = columns_of(s, judged.set);
  out.fit = judged.fit;
  if (has_friction(s)) out.friction = 0;
  for (const Chosen& c : s.chosen) {
    out.skew_s += c.skew_s;
    if (c.path.hz > 0.0) out.path = c.path;
  }
  take_change(s, out);
  for (const Chosen& c : s.chosen)
    out.changes.insert(out.changes.end(), c.changes.begin(), c.changes.end());
  out.ridge = ridge(s);
  Joint joint = fit_jointly(out, s.records, out.ridge, s.scale);
  const bool struck = std::any_of(s.chosen.begin(), s.chosen.end(), [](const Chosen& c) {
    return c.step.effect == "impulsive_input";
  });
  if (s.refine && !struck) refine_by_motion(s.records, s.scale, s.screened, out, joint);
  for (std::size_t i = 0; i < set.size(); ++i)
    s.library.columns[static_cast<std::size_t>(set[i])] = out.columns[i];
  evaluate_columns(s);
  out.terms = terms(s);
  describe(s, joint, out, s.chosen, set, notes);
  out.law = document_of(out, joint, s.scale);
  return out;
}

/// What the runners-up of a step would have left in its place.
std::vector<JudgedCandidate> runners_up_of(const State& s, std::size_t i, double before_nmse) {
  std::vector<JudgedCandidate> out;
  std::vector<Regressor> more;
  for (const Candidate& c : s.chosen[i].runners_up)
    for (const Eigen::Index column : c.columns) more.push_back(s.library.at(column));
  if (more.empty()) return out;
  const TrialFits fits{records_at(s, i), base_with(s, i, true), more};
  Eigen::Index place = 0;
  for (const Candidate& c : s.chosen[i].runners_up) {
    ColumnSet set(c.columns.size());
    std::iota(set.begin(), set.end(), place);
    place += static_cast<Eigen::Index>(set.size());
    const Fit fit = fits.best(set);
    if (fit.ok)
      out.push_back({c.effect, fit.held_out_nmse, 1.0 - fit.held_out_nmse / before_nmse, 0.0});
  }
  return out;
}

/// The error before and after each step, and what its runners-up would have left, all with the same
/// base and linear terms and on the same records.
void chain(State& s, const Explanation& out) {
  double before = out.base.fit.held_out_nmse;
  const std::size_t first = count_of_base(s);
  for (std::size_t i = first; i < s.chosen.size(); ++i) {
    Step& step = s.chosen[i].step;
    step.runners_up = runners_up_of(s, i, before);
    step.held_out_before = before;
    const bool last = i + 1 == s.chosen.size();
    const bool same = !s.chosen[i].changes.empty();
    step.held_out_after = last || same
                              ? out.final.fit.held_out_nmse
                              : best_fit(records_at(s, i + 1), base_with(s, i + 1)).held_out_nmse;
    step.gain = 1.0 - step.held_out_after / before;
    before = step.held_out_after;
    step.terms = out.base.terms;
    for (std::size_t k = first; k <= i; ++k) step.terms.push_back(s.chosen[k].step.effect);
  }
}

/// What all columns together leave that is held out, the best that any law of the library reaches.
Fit richest(const State& s) {
  ColumnSet all(s.library.columns.size());
  std::iota(all.begin(), all.end(), 0);
  return s.evaluated->regression.fit(all, kRichRidge);
}

/// What a complete law would leave, never more than a law that was tried does.
void find_floor(const State& s, Explanation& out) {
  Law law{out.final.columns, out.final.fit.theta, columns_of(s, s.library.friction), ridge(s),
          s.scale};
  if (out.final.free_run.segments > 0) law.moves = law_of(out.final, s.scale);
  const Floor floor = surrogate_floor(s.records, law);
  const Fit rich = richest(s);
  double reached = out.final.fit.held_out_nmse;
  if (rich.ok) reached = std::min(reached, rich.held_out_nmse);
  out.final.floor_nmse = std::min(floor.nmse, reached);
  out.final.floor_by = reached < floor.nmse              ? "the best law of the library"
                       : floor.noise_share > kStructured ? "the force's noise"
                                                         : "errors of the measured motion";
  out.final.floor_noise_share =
      std::min(1.0, floor.noise_share * floor.nmse / std::max(out.final.floor_nmse, 1e-300));
  // Noise of a force cell need not be white. What is Gaussian, as loud at any time and in any
  // motion, and what all columns together cannot predict, no effect makes.
  if (filtered(s) || out.is_complete() || !s.alike.empty()) return;
  const Remainder left = what_is_left(s.records, out.final);
  if (!left.is_like_noise() || left.nmse < out.final.floor_nmse) return;
  if (!rich.ok || rich.held_out_nmse < kUntouched * out.final.fit.held_out_nmse) return;
  out.final.floor_nmse = left.nmse;
  out.final.floor_noise_share = 1.0;
  out.final.floor_by = "the force's noise";
  out.notes.push_back(fmt::format(
      "What is left away from the reversals, {:.4g} N rms, is Gaussian, as loud at any time and "
      "speed, and nothing that the motion predicts: it counts as noise of the force, though it is "
      "not white.",
      left.rms_n));
}

/// A mass, a spring, friction or damping below nothing.
std::string impossible(const Model& model) {
  std::string out;
  // Where damping grows with the deflection, it may drive about the middle (Van der Pol).
  const bool may_drive =
      std::any_of(model.columns.begin(), model.columns.end(),
                  [](const Regressor& c) { return c.kind == Kind::kSquareVelocity; });
  for (const Parameter& p : model.parameters) {
    if (may_drive && p.name == "viscous") continue;
    const bool is_level = p.name == "moving_mass" || p.name == "stiffness" ||
                          p.name.starts_with("coulomb") || p.name.starts_with("viscous");
    if (!is_level || p.value > -kImpossible * p.std) continue;
    out += (out.empty() ? "" : ", ") + fmt::format("{} {:.4g} {}", p.name, p.value, p.unit);
  }
  return out;
}

}  // namespace

Explanation search(const Config& config, const std::vector<Series>& records, bool base_is_declared,
                   bool refine) {
  State s{config, records};
  s.refine = refine;
  s.library.base_is_declared = base_is_declared;
  Explanation out;
  for (const Series& r : records) out.records.push_back(r.record);
  out.whole_records = s.evaluated->regression.folds() == records.size();
  if (filtered(s)) out.filter_hz = records.front().config.corner_hz;
  if (s.library.may_add_spring) take_dominant_spring(s);
  for (const std::string& effect : s.library.base_searched) take_of_base(s, effect);
  const std::size_t first = s.chosen.size();
  if (s.library.wants_impacts) leave_impacts_out(s);
  complete_base_by_motion(s);
  do refine_width(s);
  while (s.chosen.size() < first + kMostSteps && forward(s));
  backward(s);
  take_change_of_memory(s);
  if (!prune_base_by_motion(s)) reconsider_base(s);
  s.spring_added = false;
  if (s.library.may_add_spring) try_linear(s, s.spring_added);
  s.mass_added = false;
  if (!filtered(s)) try_mass(s);
  ColumnSet set;
  out.final = final_model(s, set, out.notes);
  s.base_takes_spring = !has_step(s) || holds_in_base(s, s.library.spring);
  s.base_takes_mass = !has_step(s) || holds_in_base(s, s.library.mass);
  std::vector<std::string> notes_of_base;
  out.base = base_model(s, notes_of_base);
  if (!out.base.fit.ok || !out.final.fit.ok) {
    out.base.fit.ok = false;
    return out;
  }
  chain(s, out);
  out.notes.insert(out.notes.begin(), s.notes.begin(), s.notes.end());
  out.rejected = s.rejected;
  out.alike = s.alike;
  out.impossible = impossible(out.final);
  if (!out.impossible.empty())
    out.notes.push_back(
        fmt::format("No damper has {}: what is left out of this model is larger "
                    "than what it names.",
                    out.impossible));
  find_floor(s, out);
  for (std::size_t i = first; i < s.chosen.size(); ++i) out.steps.push_back(s.chosen[i].step);
  return out;
}

}  // namespace dampline::app::rig

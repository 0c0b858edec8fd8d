// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "app/diagnosis/rig/regression.hpp"
#include "app/diagnosis/rig/remainder.hpp"
#include "app/diagnosis/rig/search.hpp"

namespace dampline::app::rig {
namespace {

constexpr double kClearGain = 0.05;   // passes on its own
constexpr double kSmallGain = 0.025;  // passes with kSignificant
constexpr double kSignificant = 2.0;
constexpr double kLaterGain = 0.2;  // what the first leaves has many likenesses
constexpr double kLaterSignificant = 3.0;
constexpr double kShortSkew = 1.0;    // samples: when within one a force changed is not known
constexpr double kRest = 0.5;         // of the excess: what takes it needs only kClearGain
constexpr double kOfExcess = 0.1;     // what an effect must take of what is left over the floor
constexpr double kMotionFloor = 0.5;  // how well the part of the floor is known that motion makes
constexpr double kSure = 4.0;         // significance that needs no excess over a noise floor
constexpr double kAlike = 0.01;       // of what either leaves
constexpr double kAlikeMost = 0.1;
constexpr double kLinear = 0.1;    // of what either leaves: a linear law goes before a curved one
constexpr double kPairGain = 0.2;  // of two effects together over the best and its companion
constexpr std::size_t kLookedAhead = 4;
constexpr std::size_t kRunnersUp = 4;

constexpr double kLeastGain = 0.1;
constexpr double kTrialSignificant = 3.0;
constexpr double kClearMemory = 0.2;
constexpr double kBetter = 0.85;  // of what the best column leaves
constexpr double kOverFloor = 1.1;
constexpr double kMemoryToo = 0.5;
constexpr double kResolved = 0.03;
constexpr double kStepPlace = 0.029;  // of the record: a tenth, evenly spread

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

bool is_clearly_better(const Fit& fit, const Fit& other) {
  return fit.held_out_nmse < kBetter * other.held_out_nmse &&
         block_t(other, fit) > kTrialSignificant;
}

}  // namespace

/// Error of the other memory's smallest form over the first one's; 0: there is none.
double Search::other_memory_of(const std::vector<Ranked>& order) {
  const auto found = std::find_if(order.begin() + 1, order.end(),
                                  [](const Ranked& r) { return is_memory(r.candidate->effect); });
  if (found == order.end()) return 0.0;
  return found->fit.held_out_nmse / order.front().fit.held_out_nmse;
}

/// Friction that would drive: the candidate stands in for something else.
bool Search::has_driving_friction(const Fit& fit) const {
  constexpr double kDeviations = 5.0;
  return library_.base_friction && base_friction_left_ &&
         fit.theta[0] < -kDeviations * std::sqrt(std::max(fit.covariance(0, 0), 0.0));
}

/// Whether its first coefficient has not the sign that it must have.
bool Search::has_other_sign(const Candidate& candidate, const Judged& judged) {
  return candidate.sign * judged.of(candidate.columns.front()).value < 0.0;
}

/// Every effect in its best form beside a constant and a spring, the one that helps most first; of
/// those that explain alike the plainest.
std::vector<Search::Ranked> Search::rank() const {
  const Judged beside_spring = judge(joined(chosen_columns(), {library_.spring}));
  const Judged beside_constant = judge(beside_both());
  std::map<std::string, Ranked> best;
  for (const Candidate& c : library_.candidates) {
    if (!can_add(c)) continue;
    const Fit& reference = (c.effect == "offset_force" ? beside_spring : beside_constant).fit;
    const Judged with = judge(beside_both(c.columns));
    if (!with.fit.ok || !reference.ok || has_other_sign(c, with)) continue;
    if (!is_memory(c.effect) && has_driving_friction(with.fit)) continue;
    const double gain = gain_of(reference, with.fit);
    Ranked& b = best[c.effect];
    if (b.candidate != nullptr && gain <= b.gain) continue;
    b = {&c, gain, block_t(reference, with.fit), with.fit};
  }
  std::vector<Ranked> order;
  order.reserve(best.size());
  for (const auto& [effect, b] : best) order.push_back(b);
  std::sort(order.begin(), order.end(),
            [](const Ranked& a, const Ranked& b) { return a.gain > b.gain; });
  std::size_t pick = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const bool linear = order[i].candidate->effect == "viscous" &&
                        order[0].candidate->effect == "quadratic_damping" &&
                        order[i].fit.held_out_nmse <= (1.0 + kLinear) * order[0].fit.held_out_nmse;
    if (linear) pick = i;
    const bool same = order[i].fit.held_out_nmse <= (1.0 + kAlike) * order[0].fit.held_out_nmse &&
                      block_t(order[i].fit, order[0].fit) < kSignificant;
    const bool plainer = order[i].candidate->columns.size() < order[pick].candidate->columns.size();
    if (same && plainer) pick = i;
  }
  if (!order.empty()) std::swap(order[0], order[pick]);
  return order;
}

/// The best fit of two effects of which one is `first`.
Fit Search::best_with(const Candidate& first) const {
  Fit out;
  for (const Candidate& c : library_.candidates) {
    if (!can_add(c) || c.effect == first.effect) continue;
    if (is_memory(c.effect) && is_memory(first.effect)) continue;
    const Judged with = judge(joined(beside_both(first.columns), c.columns));
    if (!with.fit.ok || has_other_sign(c, with) || has_other_sign(first, with)) continue;
    if (with.fit.beats(out)) out = with.fit;
  }
  return out;
}

/// One effect may stand in for two that are there: the one whose best companion leaves clearly less
/// goes first.
void Search::prefer_beside_another(std::vector<Ranked>& order) const {
  if (order.size() < 2 || is_memory(order[0].candidate->effect)) return;
  const double floor = floor_of(joined(chosen_columns(), order[0].candidate->columns)).nmse;
  if (order[0].fit.held_out_nmse < Explanation::kIncompleteAbove * floor) return;
  Fit best = best_with(*order[0].candidate);
  std::size_t pick = 0;
  for (std::size_t i = 1; i < std::min(order.size(), kLookedAhead); ++i) {
    const Fit fit = best_with(*order[i].candidate);
    if (!fit.ok || !best.ok) continue;
    if (fit.held_out_nmse > (1.0 - kPairGain) * best.held_out_nmse) continue;
    if (block_t(best, fit) < kLaterSignificant) continue;
    best = fit;
    pick = i;
  }
  std::rotate(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(pick),
              order.begin() + static_cast<std::ptrdiff_t>(pick) + 1);
}

/// What is even leaves a mean, which a constant explains in part: each in the place of the other.
void Search::prefer_to_offset(std::vector<Ranked>& order) const {
  if (order.empty() || order[0].candidate->effect != "offset_force") return;
  const ColumnSet now = joined(chosen_columns(), {library_.spring});
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (order[i].candidate->sign != 0 && order[i].candidate->effect != "bump_stop") continue;
    for (const Candidate& c : library_.candidates) {
      if (c.effect != order[i].candidate->effect) continue;
      const Fit instead = judge(joined(now, c.columns)).fit;
      if (!instead.ok || instead.held_out_nmse > order[0].fit.held_out_nmse) continue;
      if (block_t(order[0].fit, instead) < kSignificant) continue;
      const Fit without = judge(now).fit;
      order[i] = {&c, gain_of(without, instead), block_t(without, instead), instead};
      std::swap(order[0], order[i]);
    }
  }
}

/// Names of two effects that predict alike; empty where one is better.
std::string Search::alike(const std::vector<Ranked>& order) const {
  for (std::size_t i = 1; i < order.size(); ++i) {
    const std::string& first = order[0].candidate->effect;
    const std::string& other = order[i].candidate->effect;
    if (is_memory(first) && is_memory(other)) continue;
    const ColumnSet& columns = order[0].candidate->columns;
    if (joined(order[i].candidate->columns, columns).size() == order[i].candidate->columns.size())
      continue;  // the same and more
    if (order[i].gain < 0.5 * order[0].gain || order[i].gain < kSmallGain) continue;
    const double more = order[i].fit.held_out_nmse / order[0].fit.held_out_nmse - 1.0;
    if (more > kAlikeMost || std::abs(block_t(order[i].fit, order[0].fit)) > kSignificant) continue;
    if (!chosen_.empty()) return fmt::format("{} or {}", first, other);
    // What else is missing may hide the difference.
    const Fit a = best_with(*order[0].candidate);
    const Fit b = best_with(*order[i].candidate);
    if (!a.ok || !b.ok || std::abs(block_t(b, a)) < kSignificant)
      return fmt::format("{} or {}", first, other);
  }
  return {};
}

bool Search::passes(const Ranked& top, double before_nmse) const {
  const Floor floor = floor_of(beside_both(top.candidate->columns));
  const double unsure = kMotionFloor * (1.0 - floor.noise_share);
  const bool sure = top.gain > kClearGain && top.t > kSure && floor.noise_share > kMotionFloor;
  if (before_nmse < Explanation::kNegligible) return false;
  if (top.needs_excess && before_nmse < Explanation::kIncompleteAbove * floor.nmse) return false;
  if (!sure && before_nmse < (1.0 + unsure) * floor.nmse) return false;
  if (top.gain * before_nmse < kOfExcess * (before_nmse - floor.nmse)) return false;
  if (chosen_.empty())
    return top.gain > kClearGain || (top.gain > kSmallGain && top.t > kSignificant);
  const bool rest =
      top.gain > kClearGain && top.gain * before_nmse > kRest * (before_nmse - floor.nmse);
  return (top.gain > kLaterGain || rest) && top.t > kLaterSignificant;
}

bool Search::forward() {
  const double before = error();
  std::vector<Ranked> order = rank();
  if (order.empty()) return false;
  const auto left_before = [](const auto& ranked) {
    return ranked.fit.held_out_nmse / (1.0 - ranked.gain);
  };
  prefer_to_offset(order);
  if (passes(order.front(), left_before(order.front()))) prefer_beside_another(order);
  const Ranked top = order.front();
  rejected_.clear();
  for (std::size_t i = 0; i < order.size() && i <= kRunnersUp; ++i)
    rejected_.push_back(
        {order[i].candidate->effect, order[i].fit.held_out_nmse, order[i].gain, order[i].t});
  const std::optional<Trial> trial = best_trial(left_before(top));
  if (take_mass(order, trial)) return true;
  if (trial && is_better(*trial, order)) {
    const Candidate no_column;
    const Ranked as_ranked{&no_column, trial->gain, trial->t, trial->fit,
                           std::abs(trial->skew_s) < kShortSkew * records_.front().interval_s};
    if (passes(as_ranked, left_before(*trial))) {
      take(*trial, before);
      return true;
    }
  }
  if (!passes(top, left_before(top))) return false;
  alike_ = alike(order);
  if (!alike_.empty()) return false;
  choose(*top.candidate, before, top.gain, top.t);
  Chosen& chosen = chosen_.back();
  chosen.step.runners_up.assign(rejected_.begin() + 1, rejected_.end());
  chosen.other_memory = other_memory_of(order);
  rejected_.clear();
  if (!filtered()) try_mass();
  if (is_memory(chosen.step.effect)) {
    refine(chosen);
    try_bouc_wen(chosen);
  }
  finish_step();
  return true;
}

/// Impacts come first: they are in every column's way. What is judged later is judged without the
/// moments about them.
void Search::leave_impacts_out() {
  const Judged before = judge({});
  const Judged rough = judge({library_.spring, library_.offset});
  if (!before.fit.ok || !rough.fit.ok || filtered()) return;
  const double floor = floor_of({library_.spring, library_.offset}).nmse;
  if (rough.fit.held_out_nmse < Explanation::kIncompleteAbove * floor) return;
  // What takes up a play, or builds up anew, may do it with a jerk.
  const std::vector<Ranked> order = rank();
  if (!order.empty() && is_memory(order.front().candidate->effect) &&
      order.front().gain > kClearMemory)
    return;
  const std::vector<Regressor> columns = columns_of(rough.set);
  std::vector<Eigen::VectorXd> left_n;
  left_n.reserve(records_.size());
  for (const Series& record : records_) left_n.push_back(left_of(record, columns, rough.fit.theta));
  const Impacts impacts = find_impacts(records_, left_n);
  if (!impacts.found()) return;
  std::vector<Series> kept = records_;
  for (std::size_t r = 0; r < kept.size(); ++r) kept[r].left_out = impacts.left_out[r];
  std::swap(records_, kept);
  auto all = std::move(evidence_);
  evaluate_columns();
  const Fit after = judge({}).fit;
  const double gain = gain_of(before.fit, after);
  if (!after.ok || gain < kLeastGain) {
    std::swap(records_, kept);
    evidence_ = std::move(all);
    return;
  }
  choose({"impulsive_input", 0.0, {}, 0}, before.fit.held_out_nmse, gain,
         block_t(before.fit, after));
  const auto count = static_cast<double>(impacts.peak_n.size());
  double mean = 0.0;
  double squares = 0.0;
  for (const double p : impacts.peak_n) mean += p / count;
  for (const double p : impacts.peak_n) squares += (p - mean) * (p - mean);
  chosen_.back().step.parameters = {
      {"impulsive_input_count", count, std::sqrt(count), ""},
      {"impulsive_input_force", mean, std::sqrt(squares / (count * (count - 1.0))), "N"}};
  finish_step();
}

TrialBase Search::trial_base() const {
  TrialBase out;
  const bool sign = library_.base_friction && base_friction_left_;
  ColumnSet set = set_of(beside_both(), 0);
  if (sign) {
    std::erase(set, library_.friction[0]);
    out.friction = columns_of(library_.friction);
  }
  out.columns = columns_of(set);
  out.ridge = ridge();
  return out;
}

/// Clearly better than what is simpler.
void Search::prefer_mode(std::optional<Trial>& best) const {
  const TrialBase base = trial_base();
  for (const auto& mode : {try_attached(records_, base), try_path(records_, base)}) {
    if (!mode) continue;
    if (!best || is_clearly_better(mode->fit, best->fit)) best = mode;
  }
}

std::optional<Trial> Search::best_trial(double before_nmse) const {
  const auto is_taken = [&](const char* effect) {
    return std::any_of(chosen_.begin(), chosen_.end(),
                       [&](const Chosen& c) { return c.step.effect == effect; });
  };
  const TrialBase base = trial_base();
  std::optional<Trial> best;
  const bool resolved = std::all_of(records_.begin(), records_.end(), is_resolved);
  if (library_.wants_skew && resolved && !is_taken("time_skew")) best = try_skew(records_, base);
  std::optional<Trial> drift;
  if (library_.wants_drift && !is_taken("time_drift")) drift = try_drift(records_, base);
  if (drift && (!best || drift->gain > best->gain)) best = drift;
  if (!library_.wants_mode || is_taken("unmodelled_mode")) return best;
  const double floor = floor_of(beside_both()).nmse;
  if (before_nmse > kOverFloor * floor) prefer_mode(best);
  return best;
}

/// Clearly better than every column: many things look a little like a delay.
bool Search::is_better(const Trial& trial, const std::vector<Ranked>& order) const {
  if (trial.gain < kLeastGain || trial.t < kTrialSignificant) return false;
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
bool Search::take_mass(const std::vector<Ranked>& order, const std::optional<Trial>& trial) {
  if (filtered() || mass_added_) return false;
  const Candidate mass{"moving_mass", 0.0, {library_.mass}, 1};
  const Fit without = judge(beside_both()).fit;
  const Judged judged = judge(beside_both(mass.columns));
  const Fit& with = judged.fit;
  if (!without.ok || !with.ok) return false;
  const double mass_kg = judged.of(library_.mass).value;
  if (!(mass_kg > 0.0)) return false;
  Trial as_trial;
  as_trial.judge(without, with);
  if (!is_better(as_trial, order)) return false;
  if (trial && trial->effect == "time_skew" && !is_clearly_better(with, trial->fit)) return false;
  if (trial && is_clearly_better(trial->fit, with)) return false;
  if (!passes({&mass, as_trial.gain, as_trial.t, with, false}, without.held_out_nmse)) return false;
  mass_added_ = true;
  notes_.push_back(fmt::format(
      "An inertia force of {:.4g} kg, which the base model does not have, was added first: "
      "held-out rrse {:.3f} -> {:.3f}. A mass on a spring whose resonance lies far above the "
      "motion looks the same. To have it in the base: [model] inertia = \"identify\"",
      mass_kg, std::sqrt(without.held_out_nmse), std::sqrt(with.held_out_nmse)));
  return true;
}

/// What is known of a trial before it is taken.
std::vector<Parameter> Search::parameters_of(const Trial& trial) const {
  if (trial.effect == "time_skew")
    return {{"time_skew", 1e3 * trial.skew_s,
             1e3 * skew_deviation(records_, trial_base(), trial.skew_s), "ms"}};
  if (trial.effect == "unmodelled_mode") {
    const Mode std = mode_deviation(records_, trial_base(), trial);
    return {{"unmodelled_mode_frequency", trial.mode.hz, std.hz, "Hz"},
            {"unmodelled_mode_damping", trial.mode.damping, std.damping, ""}};
  }
  std::vector<Parameter> out{{"time_drift_" + trial.parameter, 0.0, 0.0, "%"}};
  if (trial.at_share > 0.0) {
    const Series& r = records_.front();
    const double length_s = r.time_s[r.size() - 1] - r.time_s[0];
    out.push_back(
        {"time_drift_time", r.time_s[0] + trial.at_share * length_s, kStepPlace * length_s, "s"});
  }
  return out;
}

void Search::take(const Trial& trial, double before) {
  std::vector<Parameter> parameters = parameters_of(trial);
  Candidate candidate{trial.effect, 0.0, {}, 0};
  for (const Regressor& c : trial.columns) candidate.columns.push_back(library_.add(c));
  choose(std::move(candidate), before, trial.gain, trial.t);
  Chosen& chosen = chosen_.back();
  chosen.skew_s = trial.skew_s;
  chosen.step.parameters = std::move(parameters);
  chosen.step.runners_up = std::exchange(rejected_, {});
  if (trial.columns.empty()) chosen.path = trial.mode;
  for (Series& record : records_) {
    if (trial.skew_s != 0.0) record = delayed(record, trial.skew_s);
    if (chosen.path.hz > 0.0) record.path = chosen.path;
  }
  evaluate_columns();
  finish_step();
}

}  // namespace dampline::app::rig

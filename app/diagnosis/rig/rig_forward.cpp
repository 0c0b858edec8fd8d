// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/diagnosis/rig/rig_rank.hpp"
#include "app/diagnosis/rig/rig_search.hpp"

namespace dampline::app {
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

}  // namespace

/// Error of the other memory's smallest form over the first one's; 0: there is none.
double RigSearch::other_memory_of(const std::vector<Ranked>& order) {
  const auto found = std::find_if(order.begin() + 1, order.end(),
                                  [](const Ranked& r) { return is_memory(r.candidate->effect); });
  if (found == order.end()) return 0.0;
  return found->fit.held_out_nmse / order.front().fit.held_out_nmse;
}

double block_t(const RigFit& before, const RigFit& after) {
  const auto n = static_cast<double>(before.block_error.size());
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t b = 0; b < before.block_error.size(); ++b) {
    const double d = before.block_error[b] - after.block_error[b];
    sum += d;
    squares += d * d;
  }
  const double variance = (squares - sum * sum / n) / (n - 1.0);
  return variance > 0.0 ? sum / std::sqrt(n * variance) : 0.0;
}

double jackknife_std(const std::vector<double>& left_out) {
  const auto n = static_cast<double>(left_out.size());
  double mean = 0.0;
  double squares = 0.0;
  for (const double x : left_out) mean += x / n;
  for (const double x : left_out) squares += (x - mean) * (x - mean);
  return std::sqrt((n - 1.0) / n * squares);
}

/// Friction that would drive: the candidate stands in for something else.
bool RigSearch::has_driving_friction(const RigFit& fit) const {
  constexpr double kDeviations = 5.0;
  return library_.base_friction && base_friction_left_ &&
         fit.theta[0] < -kDeviations * std::sqrt(std::max(fit.covariance(0, 0), 0.0));
}

/// Every effect in its best form beside a constant and a spring, the one that helps most first; of
/// those that explain alike the plainest.
std::vector<RigSearch::Ranked> RigSearch::rank() const {
  const ColumnSet now = chosen_columns();
  const ColumnSet both = joined(now, {library_.spring, library_.offset});
  const Judged beside_spring = judge(joined(now, {library_.spring}));
  const Judged beside_both = judge(both);
  std::map<std::string, Ranked> best;
  for (const RigCandidate& c : library_.candidates) {
    if (!can_add(c)) continue;
    const Judged& reference = c.effect == "offset_force" ? beside_spring : beside_both;
    const Judged with = judge(joined(both, c.columns));
    if (!with.fit.ok || !reference.fit.ok) continue;
    const ColumnSet set = set_of(joined(both, c.columns), with.width);
    const Eigen::Index at = place_of(set, c.columns.front());
    if (c.sign * with.fit.theta[at] < 0.0) continue;
    if (!is_memory(c.effect) && has_driving_friction(with.fit)) continue;
    const double gain = 1.0 - with.fit.held_out_nmse / reference.fit.held_out_nmse;
    Ranked& b = best[c.effect];
    if (b.candidate != nullptr && gain <= b.gain) continue;
    b = {&c, gain, block_t(reference.fit, with.fit), with.fit};
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
RigFit RigSearch::best_with(const RigCandidate& first) const {
  const ColumnSet both =
      joined(joined(chosen_columns(), {library_.spring, library_.offset}), first.columns);
  RigFit out;
  for (const RigCandidate& c : library_.candidates) {
    if (!can_add(c) || c.effect == first.effect) continue;
    if (is_memory(c.effect) && is_memory(first.effect)) continue;
    const Judged with = judge(joined(both, c.columns));
    if (!with.fit.ok) continue;
    const ColumnSet set = set_of(joined(both, c.columns), with.width);
    const Eigen::Index at = place_of(set, c.columns.front());
    const Eigen::Index at_first = place_of(set, first.columns.front());
    if (c.sign * with.fit.theta[at] < 0.0 || first.sign * with.fit.theta[at_first] < 0.0) continue;
    if (!out.ok || with.fit.held_out_nmse < out.held_out_nmse) out = with.fit;
  }
  return out;
}

/// One effect may stand in for two that are there: the one whose best companion leaves clearly less
/// goes first.
void RigSearch::prefer_beside_another(std::vector<Ranked>& order) const {
  if (order.size() < 2 || is_memory(order[0].candidate->effect)) return;
  const double floor = floor_of(joined(chosen_columns(), order[0].candidate->columns)).nmse;
  if (order[0].fit.held_out_nmse < RigExplanation::kIncompleteAbove * floor) return;
  RigFit best = best_with(*order[0].candidate);
  std::size_t pick = 0;
  for (std::size_t i = 1; i < std::min(order.size(), kLookedAhead); ++i) {
    const RigFit fit = best_with(*order[i].candidate);
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
void RigSearch::prefer_to_offset(std::vector<Ranked>& order) const {
  if (order.empty() || order[0].candidate->effect != "offset_force") return;
  const ColumnSet now = joined(chosen_columns(), {library_.spring});
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (order[i].candidate->sign != 0 && order[i].candidate->effect != "bump_stop") continue;
    for (const RigCandidate& c : library_.candidates) {
      if (c.effect != order[i].candidate->effect) continue;
      const Judged instead = judge(joined(now, c.columns));
      if (!instead.fit.ok || instead.fit.held_out_nmse > order[0].fit.held_out_nmse) continue;
      if (block_t(order[0].fit, instead.fit) < kSignificant) continue;
      order[i] = {&c, 1.0 - instead.fit.held_out_nmse / judge(now).fit.held_out_nmse,
                  block_t(judge(now).fit, instead.fit), instead.fit};
      std::swap(order[0], order[i]);
    }
  }
}

/// Names of two effects that predict alike; empty where one is better.
std::string RigSearch::alike(const std::vector<Ranked>& order) const {
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
    const RigFit a = best_with(*order[0].candidate);
    const RigFit b = best_with(*order[i].candidate);
    if (!a.ok || !b.ok || std::abs(block_t(b, a)) < kSignificant)
      return fmt::format("{} or {}", first, other);
  }
  return {};
}

bool RigSearch::passes(const Ranked& top, double before_nmse) const {
  const RigFloor floor = floor_of(
      joined(chosen_columns(), joined({library_.spring, library_.offset}, top.candidate->columns)));
  const double unsure = kMotionFloor * (1.0 - floor.noise_share);
  const bool sure = top.gain > kClearGain && top.t > kSure && floor.noise_share > kMotionFloor;
  if (before_nmse < RigExplanation::kNegligible) return false;
  if (top.needs_excess && before_nmse < RigExplanation::kIncompleteAbove * floor.nmse) return false;
  if (!sure && before_nmse < (1.0 + unsure) * floor.nmse) return false;
  if (top.gain * before_nmse < kOfExcess * (before_nmse - floor.nmse)) return false;
  if (chosen_.empty())
    return top.gain > kClearGain || (top.gain > kSmallGain && top.t > kSignificant);
  const bool rest =
      top.gain > kClearGain && top.gain * before_nmse > kRest * (before_nmse - floor.nmse);
  return (top.gain > kLaterGain || rest) && top.t > kLaterSignificant;
}

bool RigSearch::forward() {
  const Judged before = judge(chosen_columns());
  std::vector<Ranked> order = rank();
  if (order.empty()) return false;
  prefer_to_offset(order);
  if (passes(order.front(), order.front().fit.held_out_nmse / (1.0 - order.front().gain)))
    prefer_beside_another(order);
  const Ranked top = order.front();
  rejected_.clear();
  for (std::size_t i = 0; i < order.size() && i <= kRunnersUp; ++i)
    rejected_.push_back(
        {order[i].candidate->effect, order[i].fit.held_out_nmse, order[i].gain, order[i].t});
  const double beside_both = top.fit.held_out_nmse / (1.0 - top.gain);
  const std::optional<RigTrial> trial = best_trial(beside_both);
  if (take_mass(order, trial)) return true;
  if (trial && is_better(*trial, order)) {
    const RigCandidate no_column;
    const Ranked as_ranked{&no_column, trial->gain, trial->t, trial->fit,
                           std::abs(trial->skew_s) < kShortSkew * records_.front().interval_s};
    if (passes(as_ranked, trial->fit.held_out_nmse / (1.0 - trial->gain))) {
      take(*trial, before.fit.held_out_nmse);
      return true;
    }
  }
  if (!passes(top, beside_both)) return false;
  alike_ = alike(order);
  if (!alike_.empty()) return false;
  Chosen chosen;
  chosen.candidate = *top.candidate;
  chosen.step.effect = top.candidate->effect;
  chosen.step.held_out_before = before.fit.held_out_nmse;
  chosen.step.gain = top.gain;
  chosen.step.block_t = top.t;
  chosen.step.runners_up.assign(rejected_.begin() + 1, rejected_.end());
  rejected_.clear();
  chosen.other_memory = other_memory_of(order);
  chosen_.push_back(chosen);
  if (!filtered()) try_mass();
  if (is_memory(chosen.step.effect)) {
    refine(chosen_.back());
    try_bouc_wen(chosen_.back());
  }
  chosen_.back().step.held_out_after = judge(chosen_columns()).fit.held_out_nmse;
  chosen_.back().step.terms = terms();
  return true;
}

}  // namespace dampline::app

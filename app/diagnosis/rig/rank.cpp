// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "app/diagnosis/rig/steps.hpp"
#include "app/diagnosis/rig/thresholds.hpp"

namespace dampline::app::rig {
namespace {

/// Friction that would drive: the candidate stands in for something else.
bool has_driving_friction(const State& s, const Fit& fit) {
  return has_friction(s) &&
         fit.theta[0] < -kDriving * std::sqrt(std::max(fit.covariance(0, 0), 0.0));
}

/// Whether its first coefficient has not the sign that it must have.
bool has_other_sign(const Candidate& candidate, const Judged& judged) {
  return candidate.sign * judged.of(candidate.columns.front()).value < 0.0;
}

/// The best fit of two effects of which one is `first`.
Fit best_with(const State& s, const Candidate& first) {
  Fit out;
  for (const Candidate& c : s.library.candidates) {
    if (!can_add(s, c) || c.effect == first.effect) continue;
    if (is_memory(c.effect) && is_memory(first.effect)) continue;
    const Judged with = judge(s, joined(beside_both(s, first.columns), c.columns));
    if (!with.fit.ok || has_other_sign(c, with) || has_other_sign(first, with)) continue;
    if (with.fit.beats(out)) out = with.fit;
  }
  return out;
}

/// Friction with a memory in its full form, a bank or a smooth law: its smallest form is rough.
Fit in_full(const State& s, const Candidate& memory) {
  State full = s;
  choose(full, memory, 0.0, 0.0);
  refine_memory(full, full.chosen.back());
  return judge_chosen(full).fit;
}

/// Whether that leaves clearly less than another fit.
bool is_clearer_in_full(const State& s, const Candidate& memory, const Fit& other) {
  const Fit fit = in_full(s, memory);
  return fit.ok && is_clearly_better(fit, other);
}

/// Whether a memory is there whatever else is: in full it leaves clearly less than the other, or
/// both together do.
bool is_needed_beside(const State& s, const Ranked& memory, const Ranked& other) {
  const Fit together =
      judge(s, joined(beside_both(s, memory.candidate->columns), other.candidate->columns)).fit;
  return (together.ok && is_clearly_better(together, memory.fit) &&
          is_clearly_better(together, other.fit)) ||
         is_clearer_in_full(s, *memory.candidate, other.fit);
}

}  // namespace

void prefer_memory(const State& s, std::vector<Ranked>& order) {
  if (order.empty() || is_memory(order[0].candidate->effect)) return;
  const auto memory = std::find_if(order.begin(), order.end(), [&](const Ranked& r) {
    return is_memory(r.candidate->effect) && r.gain > kMemoryToo * order[0].gain;
  });
  if (memory == order.end() || !is_clearer_in_full(s, *memory->candidate, order[0].fit)) return;
  std::rotate(order.begin(), memory, memory + 1);
}

std::vector<Ranked> rank(const State& s) {
  const Judged beside_spring = judge(s, joined(chosen_columns(s), {s.library.spring}));
  const Judged beside_constant = judge(s, beside_both(s));
  std::map<std::string, Ranked> best;
  for (const Candidate& c : s.library.candidates) {
    if (!can_add(s, c)) continue;
    const Fit& reference = (c.effect == "offset_force" ? beside_spring : beside_constant).fit;
    const Judged with = judge(s, beside_both(s, c.columns));
    if (!with.fit.ok || !reference.ok || has_other_sign(c, with)) continue;
    // Damping that grows with the deflection may drive about the middle.
    const bool may_drive = is_memory(c.effect) || c.effect == "progressive_damping";
    if (!may_drive && has_driving_friction(s, with.fit)) continue;
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

void prefer_beside_another(const State& s, std::vector<Ranked>& order) {
  if (order.size() < 2 || is_memory(order[0].candidate->effect)) return;
  const double floor = floor_of(s, joined(chosen_columns(s), order[0].candidate->columns)).nmse;
  if (order[0].fit.held_out_nmse < kIncompleteAbove * floor) return;
  Fit best = best_with(s, *order[0].candidate);
  std::size_t pick = 0;
  for (std::size_t i = 1; i < std::min(order.size(), kLookedAhead); ++i) {
    const Fit fit = best_with(s, *order[i].candidate);
    if (!fit.ok || !best.ok) continue;
    if (fit.held_out_nmse > (1.0 - kPairGain) * best.held_out_nmse) continue;
    if (block_t(best, fit) < kLaterSignificant) continue;
    best = fit;
    pick = i;
  }
  std::rotate(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(pick),
              order.begin() + static_cast<std::ptrdiff_t>(pick) + 1);
}

void prefer_to_offset(const State& s, std::vector<Ranked>& order) {
  if (order.empty() || order[0].candidate->effect != "offset_force") return;
  const ColumnSet now = joined(chosen_columns(s), {s.library.spring});
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (order[i].candidate->sign != 0 && order[i].candidate->effect != "bump_stop") continue;
    for (const Candidate& c : s.library.candidates) {
      if (c.effect != order[i].candidate->effect) continue;
      const Fit instead = judge(s, joined(now, c.columns)).fit;
      if (!instead.ok || instead.held_out_nmse > order[0].fit.held_out_nmse) continue;
      if (block_t(order[0].fit, instead) < kSignificant) continue;
      const Fit without = judge(s, now).fit;
      order[i] = {&c, gain_of(without, instead), block_t(without, instead), instead};
      std::swap(order[0], order[i]);
    }
  }
}

std::string prefer_viscoelastic(State& s, std::vector<Ranked>& order) {
  if (!s.library.wants_viscoelastic || !is_memory(order.front().candidate->effect)) return {};
  const std::string memory = order.front().candidate->effect;
  const auto element = best_viscoelastic(s.records, trial_base(s), viscoelastic_times(s.scale));
  if (!element) return {};
  const Fit full = in_full(s, *order.front().candidate);
  const double more = element->fit.held_out_nmse / full.held_out_nmse - 1.0;
  if (more > kAlikeMost || is_clearly_better(full, element->fit)) return {};
  if (!is_clearly_better(element->fit, full)) return fmt::format("{} or viscoelastic", memory);
  const Eigen::Index column = s.library.add(element->column);
  s.library.candidates.push_back({"viscoelastic", element->column.a, {column}, 1});
  evaluate_added(s);
  order = rank(s);
  const auto found = std::find_if(order.begin(), order.end(), [](const Ranked& r) {
    return r.candidate->effect == "viscoelastic";
  });
  if (found != order.end()) std::rotate(order.begin(), found, found + 1);
  return {};
}

std::string alike(const State& s, const std::vector<Ranked>& order) {
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
    if (is_memory(first) && is_needed_beside(s, order[0], order[i])) continue;
    if (has_step(s)) return fmt::format("{} or {}", first, other);
    // What else is missing may hide the difference.
    const Fit a = best_with(s, *order[0].candidate);
    const Fit b = best_with(s, *order[i].candidate);
    if (!a.ok || !b.ok || std::abs(block_t(b, a)) < kSignificant)
      return fmt::format("{} or {}", first, other);
  }
  return {};
}

double other_memory_of(const std::vector<Ranked>& order) {
  const auto found = std::find_if(order.begin() + 1, order.end(),
                                  [](const Ranked& r) { return is_memory(r.candidate->effect); });
  if (found == order.end()) return 0.0;
  return found->fit.held_out_nmse / order.front().fit.held_out_nmse;
}

}  // namespace dampline::app::rig

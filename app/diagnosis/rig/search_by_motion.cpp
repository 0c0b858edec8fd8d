// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/diagnosis/rig/by_motion.hpp"
#include "app/diagnosis/rig/steps.hpp"
#include "app/diagnosis/rig/thresholds.hpp"

namespace dampline::app::rig {
namespace {

/// Other forms are tried whatever the first leaves.
const double kInAnyCase = std::numeric_limits<double>::infinity();

/// The motion of a driven mass by what was chosen and some columns more.
Screened screened_with(const State& s, const ColumnSet& more, double forms_below) {
  const auto struck = [](const Chosen& c) { return c.step.effect == "impulsive_input"; };
  if (!s.refine || !filtered(s) || std::any_of(s.chosen.begin(), s.chosen.end(), struck)) return {};
  const Judged judged = judge(s, joined(chosen_columns(s), more));
  if (!judged.fit.ok) return {};
  Model model;
  model.columns = columns_of(s, judged.set);
  model.fit = judged.fit;
  model.ridge = ridge(s);
  for (const Chosen& c : s.chosen) {
    model.skew_s += c.skew_s;
    if (c.path.hz > 0.0) model.path = c.path;
    model.changes.insert(model.changes.end(), c.changes.begin(), c.changes.end());
  }
  return screen_by_motion(s.records, s.scale, std::move(model), forms_below);
}

/// An effect by its motion.
struct Moving {
  std::size_t place{0};  ///< in the order
  bool friction{true};   ///< the base's stays beside it; otherwise damping stands for it
  Screened screened;
};

/// Figures that the record has to pay for.
std::size_t figures_of(const Ranked& r, bool friction) {
  return r.candidate->columns.size() + (r.candidate->place > 0.0 ? 1 : 0) + (friction ? 1 : 0);
}

Moving moved_with(const State& s, const std::vector<Ranked>& order, std::size_t place,
                  bool friction, double forms_below) {
  const ColumnSet& columns = order[place].candidate->columns;
  if (friction) return {place, true, screened_with(s, columns, forms_below)};
  State without = s;
  set_base(without, false, true);
  return {place, false, screened_with(without, columns, forms_below)};
}

bool is_damped(const State& s) {
  return std::find(s.library.base.begin(), s.library.base.end(), s.library.viscous) !=
         s.library.base.end();
}

/// The form that the motion found, in the library; with damping instead of the base's friction
/// where that goes better.
void take_form(State& s, const Candidate& candidate, const Moving& moving) {
  if (!moving.friction) set_base(s, false, true);
  const ColumnSet set = judge(s, joined(chosen_columns(s), candidate.columns)).set;
  for (const Eigen::Index c : candidate.columns)
    s.library.columns[static_cast<std::size_t>(c)] =
        moving.screened.model.columns[static_cast<std::size_t>(place_of(set, c))];
  evaluate_columns(s);
  s.followed = true;
  s.screened = moving.screened;
}

/// Effects of an order, until one follows and no later one's equations speak for it; those that
/// come in several forms in the best one, where the first comes near.
std::vector<Moving> all_moved(const State& s, const std::vector<Ranked>& order,
                              const Screened& now) {
  std::vector<Moving> out;
  double least = std::numeric_limits<double>::infinity();
  double gain = -std::numeric_limits<double>::infinity();  // of the first that follows
  const std::size_t count = std::min(order.size(), kScreenedEffects);
  for (std::size_t i = 0; i < count && order[i].gain > kLookedOn * gain; ++i) {
    const bool instead =
        is_memory(order[i].candidate->effect) && has_friction(s) && !s.library.base_is_declared;
    for (const bool friction : {true, false}) {
      if (!friction && !instead) continue;
      Moving m = moved_with(s, order, i, friction, kBaseLacks * now.nmse);
      if (!m.screened.ok) continue;
      if (m.screened.followed) gain = std::max(gain, order[i].gain);
      least = std::min(least, m.screened.nmse);
      out.push_back(std::move(m));
      if (out.back().screened.nmse < kExact) return out;
    }
  }
  const auto follows = [](const Moving& m) { return m.screened.followed; };
  if (std::any_of(out.begin(), out.end(), follows)) return out;
  std::size_t looks = 0;
  for (Moving& m : out)
    if (!m.screened.compared && m.screened.nmse < kOtherToo * least && ++looks <= kFormsOf)
      m = moved_with(s, order, m.place, m.friction, kInAnyCase);
  return out;
}

/// Twice the log likelihood that b has over a, as white noise has it.
double likelier(const Screened& a, const Screened& b) {
  if (std::max(a.nmse, b.nmse) < kExact) return 0.0;
  return std::log(a.nmse / b.nmse) * a.samples;
}

/// Keeps those that leave the like of the one that leaves least; of them the one with the fewest
/// figures.
std::vector<Moving>::iterator plainest_of_best(std::vector<Moving>& moved,
                                               const std::vector<Ranked>& order) {
  const auto best = std::min_element(
      moved.begin(), moved.end(),
      [](const Moving& a, const Moving& b) { return a.screened.nmse < b.screened.nmse; });
  const Screened least = best->screened;
  std::erase_if(moved, [&](const Moving& m) { return likelier(m.screened, least) > kSameLeft; });
  return std::min_element(moved.begin(), moved.end(), [&](const Moving& a, const Moving& b) {
    return figures_of(order[a.place], a.friction) < figures_of(order[b.place], b.friction);
  });
}

}  // namespace

ByMotion prefer_what_moves(State& s, std::vector<Ranked>& order) {
  if (!s.refine || !filtered(s)) return ByMotion::kUnknown;
  // Noise of the force moves the mass too: no law follows it.
  if (is_force_noisy(s.records) && floor_of(s, chosen_columns(s)).noise_share > kStructured)
    return ByMotion::kUnknown;
  const Screened now = screened_with(s, {}, 0.0);
  if (!now.ok) return ByMotion::kUnknown;
  const auto stop = [&] {
    s.followed = true;
    s.screened = now;
    return ByMotion::kNothing;
  };
  if (now.is_noise) return stop();
  std::vector<Moving> moved = all_moved(s, order, now);
  std::erase_if(moved, [&](const Moving& m) {
    return !m.screened.followed || likelier(now, m.screened) < kSurelyLess;
  });
  if (moved.empty()) return now.followed ? stop() : ByMotion::kUnknown;
  const auto pick = plainest_of_best(moved, order);
  for (const Moving& m : moved) {
    if (m.place == pick->place ||
        figures_of(order[m.place], m.friction) > figures_of(order[pick->place], pick->friction))
      continue;
    s.alike = fmt::format("{} or {}", order[pick->place].candidate->effect,
                          order[m.place].candidate->effect);
    return ByMotion::kAlike;
  }
  if (!pick->screened.compared)
    *pick = moved_with(s, order, pick->place, pick->friction, kInAnyCase);
  take_form(s, *order[pick->place].candidate, *pick);
  const auto place = order.begin() + static_cast<std::ptrdiff_t>(pick->place);
  std::rotate(order.begin(), place, place + 1);
  return ByMotion::kFirst;
}

void complete_base_by_motion(State& s) {
  const bool damped = is_damped(s);
  if (s.library.base_is_declared || s.library.base_friction == damped) return;
  const Screened one = screened_with(s, {}, 0.0);
  if (!one.ok || one.is_noise) return;
  set_base(s, true, true);
  const Screened both = screened_with(s, {}, 0.0);
  if (!both.ok || both.nmse > kBaseLacks * one.nmse) set_base(s, !damped, damped);
}

bool prune_base_by_motion(State& s) {
  if (!s.followed || s.library.base_is_declared) return false;
  const bool damped = is_damped(s);
  const bool rubbed = has_friction(s);
  if (!rubbed) return true;
  for (const bool friction : {false, true}) {
    if (friction && !damped) continue;  // as it is
    set_base(s, friction, !friction);
    const Screened one = screened_with(s, {}, 0.0);
    if (!one.followed || likelier(one, s.screened) > kSameLeft) continue;
    s.screened = one;
    return true;
  }
  set_base(s, rubbed, damped);
  return true;
}

}  // namespace dampline::app::rig

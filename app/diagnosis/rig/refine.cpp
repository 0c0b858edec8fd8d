// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <utility>

#include "app/diagnosis/rig/bank.hpp"
#include "app/diagnosis/rig/steps.hpp"
#include "app/diagnosis/rig/thresholds.hpp"

namespace dampline::app::rig {
namespace {

/// The hats of an element; the middle one of all but the first would be the first's again.
ColumnSet hats_of(const BankElement& element, bool first) {
  ColumnSet out = element.hats;
  if (!first) out.erase(out.begin() + Regressor::kHats / 2);
  return out;
}

/// Where the widest law of friction is the best, still wider ones, which are hardly another thing
/// than viscous damping, have to be clearly better.
void widen(State& s) {
  if (!has_friction(s) || !s.library.base_is_declared) return;
  const Judged now = judge(s, beside_both(s));
  const auto width_of = [&](std::size_t i) { return s.library.at(s.library.friction[i]).a; };
  for (std::size_t i = 0; i < s.library.friction.size(); ++i)
    if (!now.fit.ok || width_of(i) > width_of(now.width)) return;
  const std::size_t before = s.library.friction.size();
  for (const double a :
       ratios(width_of(now.width), kWidestOfAll * s.scale.velocity_mps, kFrictionWidthRatio))
    s.library.friction.push_back(s.library.add({Kind::kSign, kFrictionWidthRatio * a, 0.0}));
  evaluate_added(s);
  if (judge(s, beside_both(s)).fit.held_out_nmse > kClearlyWider * now.fit.held_out_nmse)
    s.library.friction.resize(before);
}

/// Where the smallest forms are close, the bank's shape decides: free play is a build-up that
/// pauses at no force.
void rename_memory(const State& s, Chosen& memory) {
  if (memory.other_memory == 0.0 || memory.other_memory > kUndecided) return;
  const Judged now = judge_chosen(s);
  const BankFigures read = read_bank(columns_of(s, now.set), now.fit.theta, longest_of(s.bank));
  if (read.play_share > kPlay) memory.step.effect = memory.candidate.effect = "backlash";
}

/// Three stop operators, their travels half as large again from one to the next, and what the
/// longest loses with speed on either side, now and soon after breakaway.
void try_bank(State& s, Chosen& memory) {
  std::vector<BankElement> elements;
  for (const double share : ratios(kBankFrom, kBankTo, kBankStep))
    elements.push_back(add_bank_element(s.library, share * memory.candidate.place));
  evaluate_added(s);
  const Candidate small = memory.candidate;
  double least = error(s);
  ColumnSet best = small.columns;
  memory.ridge = kBankRidge;
  for (std::size_t i = kBankSpread; i + kBankSpread < elements.size(); ++i) {
    const BankElement& shortest = elements[i - kBankSpread];
    const BankElement& longest = elements[i + kBankSpread];
    ColumnSet columns = joined(hats_of(elements[i], true), hats_of(shortest, false));
    columns = joined(joined(columns, hats_of(longest, false)), longest.speed);
    memory.candidate.columns = columns;
    const Fit fit = judge_chosen(s).fit;
    if (!fit.ok || fit.held_out_nmse >= least) continue;
    least = fit.held_out_nmse;
    best = columns;
    s.bank = {shortest, elements[i], longest};
  }
  memory.candidate.columns = best;
  if (s.bank.empty()) {
    memory.ridge = 0.0;
    return;
  }
  s.base_friction_left = false;
  s.base_friction_left = error(s) > least;
  rename_memory(s, memory);
}

/// One smooth law with two figures instead of a bank, where it leaves clearly less.
void try_bouc_wen(State& s, Chosen& memory) {
  const Chosen before = memory;
  const bool friction = s.base_friction_left;
  const double by_bank = error(s);
  memory.candidate.columns.clear();
  memory.ridge = 0.0;
  s.base_friction_left = true;
  s.bouc_wen = best_bouc_wen(s.records, trial_base(s), s.scale.deflection_m);
  if (s.bouc_wen) {
    memory.candidate.columns = {s.library.add(s.bouc_wen->column)};
    evaluate_added(s);
    const double with = error(s);
    s.base_friction_left = false;
    const double alone = error(s);
    s.base_friction_left = with < kFrictionStays * alone;
    if (std::min(with, alone) < kSmoother * by_bank) {
      memory.step.effect = memory.candidate.effect = "presliding_hysteresis";
      s.bank.clear();
      return;
    }
  }
  s.bouc_wen.reset();
  memory = before;
  s.base_friction_left = friction;
}

}  // namespace

void refine_memory(State& s, Chosen& memory) {
  try_bank(s, memory);
  try_bouc_wen(s, memory);
}

void refine_width(State& s) {
  widen(s);
  double ratio = kFrictionWidthRatio;
  for (int round = 0; round < kWidthRounds; ++round) {
    if (!has_friction(s)) return;
    const Judged now = judge(s, beside_both(s));
    if (!now.fit.ok) return;
    const Regressor best = s.library.at(s.library.friction[now.width]);
    if (!is_smooth(best, s.scale)) return;
    ratio = std::sqrt(ratio);
    for (const double a : {best.a / ratio, best.a * ratio})
      s.library.friction.push_back(s.library.add({Kind::kSign, a, 0.0}));
    evaluate_added(s);
  }
}

}  // namespace dampline::app::rig

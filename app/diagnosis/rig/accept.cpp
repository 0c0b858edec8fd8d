// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "app/diagnosis/rig/steps.hpp"
#include "app/diagnosis/rig/thresholds.hpp"

namespace dampline::app::rig {

bool is_clearly_better(const Fit& fit, const Fit& other) {
  return fit.held_out_nmse < kBetter * other.held_out_nmse &&
         block_t(other, fit) > kTrialSignificant;
}

bool passes(const State& s, const Ranked& top, double before_nmse) {
  const Floor floor = floor_of(s, beside_both(s, top.candidate->columns));
  const double unsure = kMotionFloor * (1.0 - floor.noise_share);
  const bool sure = top.gain > kClearGain && top.t > kSure && floor.noise_share > kMotionFloor;
  if (before_nmse < kNegligible) return false;
  if (top.needs_excess && before_nmse < kIncompleteAbove * floor.nmse) return false;
  if (!sure && before_nmse < (1.0 + unsure) * floor.nmse) return false;
  if (top.gain * before_nmse < kOfExcess * (before_nmse - floor.nmse)) return false;
  if (!has_step(s)) return top.gain > kClearGain || (top.gain > kSmallGain && top.t > kSignificant);
  const bool rest =
      top.gain > kClearGain && top.gain * before_nmse > kRest * (before_nmse - floor.nmse);
  // A memory's form is never whole: what it leaves has the look of much else.
  if (remembers(s)) return top.gain > kBesideMemory && top.t > kLaterSignificant;
  return (top.gain > kLaterGain || rest) && top.t > kLaterSignificant;
}

bool is_better(const State& s, const Trial& trial, const std::vector<Ranked>& order) {
  if (trial.gain < kLeastGain || trial.t < kTrialSignificant) return false;
  if (!is_clearly_better(trial.fit, order.front().fit)) return false;
  if (trial.effect == "time_skew" && remembers(s) && trial.gain < kClearlyLate) return false;
  // What memory rounds, a delay or a mode rounds too: its smallest form is too rough to tell.
  const bool memory = std::any_of(order.begin(), order.end(), [&](const Ranked& r) {
    return is_memory(r.candidate->effect) && r.gain > kMemoryToo * trial.gain;
  });
  if (!memory) return true;
  const auto smooth = best_bouc_wen(s.records, trial_base(s), s.scale.deflection_m);
  return !smooth || trial.fit.held_out_nmse < kBetter * smooth->fit.held_out_nmse;
}

}  // namespace dampline::app::rig

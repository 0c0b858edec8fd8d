// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/diagnosis/rig/steps.hpp"
#include "app/diagnosis/rig/thresholds.hpp"

namespace dampline::app::rig {

void try_linear(State& s, bool& added) {
  if (added) return;
  const double without = error(s);
  added = true;
  added = error(s) < (1.0 - kNeeded) * without;
}

void try_mass(State& s) {
  try_linear(s, s.mass_added);
  s.mass_added = s.mass_added && judge_chosen(s).of(s.library.mass).value > 0.0;
}

void take_dominant_spring(State& s) {
  const Judged without = judge(s, {});
  const Judged with = judge(s, {s.library.spring});
  if (!with.fit.ok || with.fit.held_out_nmse > kDominantSpring * without.fit.held_out_nmse) return;
  s.spring_added = true;
  s.notes.push_back(
      fmt::format("A linear spring, which the base model does not have, was added first: held-out "
                  "rrse {:.3f} -> {:.3f}. To have it in the base: [model] stiffness = \"identify\"",
                  std::sqrt(without.fit.held_out_nmse), std::sqrt(with.fit.held_out_nmse)));
}

void backward(State& s) {
  for (std::size_t i = 0; s.chosen.size() > 1 && i < s.chosen.size();) {
    const double with = error(s);
    const Chosen removed = s.chosen[i];
    if (removed.of_base || is_memory(removed.candidate.effect) ||
        removed.candidate.columns.empty()) {
      ++i;
      continue;
    }
    s.chosen.erase(s.chosen.begin() + static_cast<std::ptrdiff_t>(i));
    const Judged without = judge_chosen(s);
    if (without.fit.ok && without.fit.held_out_nmse < (1.0 + kNeeded) * with) {
      i = 0;
      continue;
    }
    s.chosen.insert(s.chosen.begin() + static_cast<std::ptrdiff_t>(i), removed);
    ++i;
  }
}

void set_base(State& s, bool friction, bool viscous) {
  s.library.base_friction = friction;
  std::erase(s.library.base, s.library.viscous);
  if (viscous) s.library.base.push_back(s.library.viscous);
  std::erase(s.library.base_terms, "coulomb");
  std::erase(s.library.base_terms, "viscous");
  if (friction) s.library.base_terms.emplace_back("coulomb");
  if (viscous) s.library.base_terms.emplace_back("viscous");
}

void reconsider_base(State& s) {
  if (s.library.base_is_declared) return;
  const auto is_chosen = [&](const char* effect) {
    return std::any_of(s.chosen.begin(), s.chosen.end(),
                       [&](const Chosen& c) { return c.step.effect == effect; });
  };
  if (is_chosen("viscous") || is_chosen("asymmetric_viscous") || is_chosen("coulomb")) return;
  const auto left_with = [&](bool friction, bool viscous) {
    set_base(s, friction, viscous);
    return error(s);
  };
  const double damped = left_with(false, true);
  const double rubbed = left_with(true, false);
  const double both = left_with(true, true);
  const bool needs_both = both < (1.0 - kNeeded) * std::min(damped, rubbed);
  set_base(s, needs_both || rubbed < damped, needs_both || damped <= rubbed);
}

}  // namespace dampline::app::rig

// SPDX-License-Identifier: MIT
// What the explainer finds between the points of a grid, and keeps when grids are drawn together.
#include <algorithm>
#include <cmath>

#include "dampline/effect/explainer.hpp"

namespace dampline::effect {
namespace {

constexpr double kGridStd = 0.29;     // of a place known to one step: 1 / sqrt(12)
constexpr double kRowsPerFact = 4.0;  // windows overlap

/// Where the parabola through three errors is least, in steps from the middle one.
double vertex(const std::array<double, 2>& side, double middle) noexcept {
  const double curvature = side[0] + side[1] - 2.0 * middle;
  if (!(side[0] > 0.0 && side[1] > 0.0 && curvature > 0.0)) return 0.0;
  return std::clamp(0.5 * (side[0] - side[1]) / curvature, -0.5, 0.5);
}

}  // namespace

/// Where the error is least between the grid's points: the vertex of the parabola through it and
/// its neighbours; its deviation from the parabola's curvature.
void Explainer::refine(const Model& model, std::size_t i, const ModelFit& final,
                       Step& step) noexcept {
  const Candidate& chosen = step.chosen;
  step.place = chosen.variant;
  step.place_std = kGridStd;
  if (is_pair(chosen)) {
    int term = ModelFit::kFirstEffect;
    for (std::size_t e = 0; e < i; ++e) term += static_cast<int>(model.effect[e].count);
    const double low = std::abs(final.theta[term]);
    const double high = std::abs(final.theta[term + 1]);
    step.place += high / (low + high);
    return;
  }
  list_candidates(base_of(final), grids_, candidates_);
  const std::size_t line = line_of(chosen.effect, chosen.form == kPitchForm, grids_);
  const std::array<double, 2> side = beside(model, i, 1, true);
  step.place += vertex(side, final.nmse);
  step.line_offset = vertex(beside(model, i, static_cast<int>(line), false), final.nmse);
  const double curvature = side[0] + side[1] - 2.0 * final.nmse;
  if (!(side[0] > 0.0 && side[1] > 0.0 && curvature > 0.0)) return;
  const double target = evidence_.total.at(kTarget, kTarget);
  step.place_std = std::clamp(std::sqrt(2.0 * kRowsPerFact / (curvature * target)), 0.05, kGridStd);
}

std::array<double, 2> Explainer::beside(const Model& model, std::size_t i, int apart,
                                        bool in_line) noexcept {
  std::array<double, 2> out{};
  const Candidate& chosen = model.effect[i];
  const std::size_t line = line_of(chosen.effect, chosen.form == kPitchForm, grids_);
  for (std::size_t c = 0; c < candidates_.count; ++c) {
    const Candidate& other = candidates_.item[c];
    if (!is_of_grid(other, chosen) || other.count != 1) continue;
    const int distance = static_cast<int>(other.variant) - static_cast<int>(chosen.variant);
    const bool one_line = other.variant / line == chosen.variant / line;
    if ((distance != apart && distance != -apart) || one_line != in_line) continue;
    Model neighbour = model;
    neighbour.effect[i] = other;
    out[distance > 0 ? 1 : 0] = fitter_.fit(neighbour).nmse;
  }
  return out;
}

/// What an explanation by other sums knows already: the first effect, at the point of its grid that
/// is now the best, and a late channel, which is no column any more.
void Explainer::keep(const GramStore& store, const Explanation& known, Explanation& out,
                     ModelFit& now) noexcept {
  for (std::size_t i = 0; i < known.step_count; ++i) {
    const bool late = known.step[i].chosen.effect == Effect::kTimeSkew;
    if (i > 0 && !late) continue;
    Step step = known.step[i];
    Candidate member = step.chosen;
    if (late) {
      member.count = 0;
    } else {
      BestOfEffects best;
      try_all(out.model, now, best);
      const Best& b = best[static_cast<std::size_t>(member.effect)];
      if (!b.ok) continue;
      step.chosen = member = b.candidate;
    }
    out.model = out.model.with(member);
    now = settle(store, out.model);
    if (late) {
      step.held_out_nmse_after = now.held_out_nmse;
      step.gain = 1.0 - step.held_out_nmse_after / step.held_out_nmse_before;
    }
    out.step[out.step_count++] = step;
  }
  out.base = known.base;
  out.base_weight = known.base_weight;
  out.base_target = known.base_target;
}

}  // namespace dampline::effect

// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/rig_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "app/diagnosis/rig/rig_noise.hpp"
#include "app/diagnosis/rig/rig_rank.hpp"

namespace dampline::app {
namespace {

constexpr double kNeeded = 0.01;  // loss without it that keeps an effect
constexpr std::size_t kMostSteps = 4;
constexpr int kWidthRounds = 3;
constexpr double kWidestOfAll = 0.9;  // of the speed's rms
constexpr double kClearlyWider = 0.9;
constexpr double kRichRidge = 1e-2;
constexpr double kUntouched = 0.95;
constexpr double kDominant = 0.5;  // of the base's error, that a spring takes

/// A column's own name may be its effect's: an offset.
void add_once(const Parameter& parameter, std::vector<Parameter>& out) {
  const bool there = std::any_of(out.begin(), out.end(),
                                 [&](const Parameter& p) { return p.name == parameter.name; });
  if (!there) out.push_back(parameter);
}

}  // namespace

RigSearch::RigSearch(const Config& config, const std::vector<RigSeries>& records)
    : records_{records}, scale_{scale_of(records)}, library_{make_library(config, scale_)} {
  evidence_ = std::make_unique<RigEvidence>(library_.columns, records_);
}

bool RigSearch::filtered() const {
  return std::any_of(library_.columns.begin(), library_.columns.end(),
                     [](const RigColumn& c) { return c.kind == RigColumn::Kind::kInertia; });
}

ColumnSet RigSearch::set_of(const ColumnSet& more, std::size_t width) const {
  ColumnSet out;
  if (library_.base_friction && base_friction_left_) out.push_back(library_.friction[width]);
  out = joined(out, library_.base);
  if (spring_added_) out = joined(out, {library_.spring});
  if (mass_added_) out = joined(out, {library_.mass});
  return joined(out, more);
}

double RigSearch::ridge() const {
  double out = 0.0;
  for (const Chosen& c : chosen_) out = std::max(out, c.ridge);
  return out;
}

RigSearch::Judged RigSearch::judge(const ColumnSet& more) const {
  Judged best;
  const bool profiled = library_.base_friction && base_friction_left_;
  for (std::size_t w = 0; w < (profiled ? library_.friction.size() : 1); ++w) {
    const RigFit fit = evidence_->fit(set_of(more, w), ridge());
    if (!fit.ok || (best.fit.ok && fit.held_out_nmse >= best.fit.held_out_nmse)) continue;
    best = {fit, w};
  }
  return best;
}

ColumnSet RigSearch::chosen_columns() const {
  ColumnSet out;
  for (const Chosen& c : chosen_) out = joined(out, c.candidate.columns);
  return out;
}

std::vector<RigColumn> RigSearch::columns_of(const ColumnSet& set) const {
  std::vector<RigColumn> out;
  out.reserve(set.size());
  for (const Eigen::Index i : set) out.push_back(library_.columns[static_cast<std::size_t>(i)]);
  return out;
}

RigFloor RigSearch::floor_of(const ColumnSet& more) const {
  const Judged judged = judge(more);
  if (!judged.fit.ok) return {};
  RigLaw law;
  law.columns = columns_of(set_of(more, judged.width));
  law.friction = columns_of(library_.friction);
  law.theta = judged.fit.theta;
  law.ridge = ridge();
  return rig_floor(records_, law);
}

bool RigSearch::can_add(const RigCandidate& candidate) const {
  return std::none_of(chosen_.begin(), chosen_.end(), [&](const Chosen& c) {
    return c.candidate.effect == candidate.effect ||
           (is_memory(c.candidate.effect) && is_memory(candidate.effect));
  });
}

std::vector<std::string> RigSearch::terms() const {
  std::vector<std::string> out = library_.base_terms;
  if (spring_added_) out.emplace_back("linear spring");
  if (mass_added_) out.emplace_back("moving mass");
  for (const Chosen& c : chosen_) out.push_back(c.candidate.effect);
  return out;
}

/// A linear term that belongs to the rig rather than to the damper stays where it helps.
void RigSearch::try_linear(bool& added) {
  if (added) return;
  const double without = judge(chosen_columns()).fit.held_out_nmse;
  added = true;
  added = judge(chosen_columns()).fit.held_out_nmse < (1.0 - kNeeded) * without;
}

/// Neither is less than nothing: a negative one would only help the fit.
void RigSearch::try_mass() {
  try_linear(mass_added_);
  const Judged now = judge(chosen_columns());
  const ColumnSet set = set_of(chosen_columns(), now.width);
  const Eigen::Index at = place_of(set, library_.mass);
  mass_added_ = mass_added_ && now.fit.theta[at] > 0.0;
}

/// A spring that carries most of the force is no effect that a damper lacks: effects are looked for
/// beside it.
void RigSearch::take_dominant_spring() {
  const Judged without = judge({});
  const Judged with = judge({library_.spring});
  if (!with.fit.ok || with.fit.held_out_nmse > kDominant * without.fit.held_out_nmse) return;
  spring_added_ = true;
  notes_.push_back(
      fmt::format("A linear spring, which the base model does not have, was added first: held-out "
                  "rrse {:.3f} -> {:.3f}. To have it in the base: [model] stiffness = \"identify\"",
                  std::sqrt(without.fit.held_out_nmse), std::sqrt(with.fit.held_out_nmse)));
}

/// Where the widest law of friction is the best, still wider ones, which are hardly another thing
/// than viscous damping, have to be clearly better.
void RigSearch::widen() {
  if (!library_.base_friction || !base_friction_left_) return;
  const ColumnSet beside = joined(chosen_columns(), {library_.spring, library_.offset});
  const Judged now = judge(beside);
  const auto width_of = [&](std::size_t i) {
    return library_.columns[static_cast<std::size_t>(library_.friction[i])].a;
  };
  for (std::size_t i = 0; i < library_.friction.size(); ++i)
    if (!now.fit.ok || width_of(i) > width_of(now.width)) return;
  const std::size_t before = library_.friction.size();
  for (const double a :
       ratios(width_of(now.width), kWidestOfAll * scale_.velocity_mps, kFrictionWidthRatio))
    library_.friction.push_back(
        library_.add({RigColumn::Kind::kSign, kFrictionWidthRatio * a, 0.0}));
  evidence_ = std::make_unique<RigEvidence>(library_.columns, records_);
  if (judge(beside).fit.held_out_nmse > kClearlyWider * now.fit.held_out_nmse)
    library_.friction.resize(before);
}

/// A smooth law of friction between two widths of the grid would leave what looks like an effect.
void RigSearch::refine_width() {
  widen();
  double ratio = kFrictionWidthRatio;
  for (int round = 0; round < kWidthRounds; ++round) {
    if (!library_.base_friction || !base_friction_left_) return;
    const Judged now = judge(joined(chosen_columns(), {library_.spring, library_.offset}));
    if (!now.fit.ok) return;
    const RigColumn best = library_.columns[static_cast<std::size_t>(library_.friction[now.width])];
    if (!is_smooth(best, scale_)) return;
    ratio = std::sqrt(ratio);
    for (const double a : {best.a / ratio, best.a * ratio})
      library_.friction.push_back(library_.add({RigColumn::Kind::kSign, a, 0.0}));
    evidence_ = std::make_unique<RigEvidence>(library_.columns, records_);
  }
}

void RigSearch::backward() {
  for (std::size_t i = 0; chosen_.size() > 1 && i < chosen_.size();) {
    const double with = judge(chosen_columns()).fit.held_out_nmse;
    const Chosen removed = chosen_[i];
    if (is_memory(removed.candidate.effect) || removed.candidate.columns.empty()) {
      ++i;
      continue;
    }
    chosen_.erase(chosen_.begin() + static_cast<std::ptrdiff_t>(i));
    const Judged without = judge(chosen_columns());
    if (without.fit.ok && without.fit.held_out_nmse < (1.0 + kNeeded) * with) {
      i = 0;
      continue;
    }
    chosen_.insert(chosen_.begin() + static_cast<std::ptrdiff_t>(i), removed);
    ++i;
  }
}

/// Noise of a force cell need not be white. What is Gaussian, as loud at any time and in any
/// motion, and what all columns together cannot predict, no effect makes.
void RigSearch::count_noise(RigExplanation& out) const {
  if (filtered() || out.is_complete() || !alike_.empty()) return;
  const RigLeft left = what_is_left(records_, out.final);
  if (!left.is_like_noise() || left.nmse < out.final.floor_nmse) return;
  ColumnSet all(library_.columns.size());
  std::iota(all.begin(), all.end(), 0);
  const RigFit rich = evidence_->fit(all, kRichRidge);
  if (!rich.ok || rich.held_out_nmse < kUntouched * out.final.fit.held_out_nmse) return;
  out.final.floor_nmse = left.nmse;
  out.final.floor_noise_share = 1.0;
  out.notes.push_back(fmt::format(
      "What is left away from the reversals, {:.4g} N rms, is Gaussian, as loud at any time and "
      "speed, and nothing that the motion predicts: it counts as noise of the force, though it is "
      "not white.",
      left.rms_n));
}

RigExplanation RigSearch::run() {
  RigExplanation out;
  for (const RigSeries& s : records_) out.records.push_back(s.record);
  out.whole_records = evidence_->folds() == records_.size();
  if (filtered()) out.filter_hz = records_.front().config.corner_hz;
  describe(out.base, judge({}), {});
  if (!library_.base_spring) take_dominant_spring();
  if (library_.wants_impacts) leave_impacts_out();
  do refine_width();
  while (chosen_.size() < kMostSteps && forward());
  backward();
  spring_added_ = false;
  if (!library_.base_spring) try_linear(spring_added_);
  mass_added_ = false;
  if (!filtered()) try_mass();
  const Judged now = judge(chosen_columns());
  describe_steps(now);
  out.rejected = rejected_;
  out.alike = alike_;
  describe(out.final, now, chosen_columns());
  for (const Chosen& c : chosen_) {
    out.final.skew_s += c.skew_s;
    if (c.path.hz > 0.0) out.final.path = c.path;
  }
  out.notes = notes_;
  const RigFloor floor = floor_of(chosen_columns());
  out.final.floor_nmse = floor.nmse;
  out.final.floor_noise_share = floor.noise_share;
  count_noise(out);
  for (const Chosen& c : chosen_) {
    out.steps.push_back(c.step);
    for (const Parameter& p : c.step.parameters) add_once(p, out.final.parameters);
  }
  return out;
}

}  // namespace dampline::app

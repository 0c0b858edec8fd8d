// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "app/diagnosis/rig/regression.hpp"
#include "app/diagnosis/rig/remainder.hpp"

namespace dampline::app::rig {
namespace {

constexpr double kNeeded = 0.01;  // loss without it that keeps an effect
constexpr std::size_t kMostSteps = 4;
constexpr int kWidthRounds = 3;
constexpr double kWidestOfAll = 0.9;  // of the speed's rms
constexpr double kClearlyWider = 0.9;
constexpr double kRichRidge = 1e-2;
constexpr double kUntouched = 0.95;
constexpr double kDominantSpring = 0.5;  // of the base's error, that a spring takes

/// A column's own name may be its effect's: an offset.
void add_once(const Parameter& parameter, std::vector<Parameter>& out) {
  const bool there = std::any_of(out.begin(), out.end(),
                                 [&](const Parameter& p) { return p.name == parameter.name; });
  if (!there) out.push_back(parameter);
}

}  // namespace

Search::Search(const Config& config, const std::vector<Series>& records)
    : records_{records}, scale_{scale_of(records)}, library_{make_library(config, scale_)} {
  evaluate_columns();
}

bool Search::filtered() const {
  return std::any_of(library_.columns.begin(), library_.columns.end(),
                     [](const Regressor& c) { return c.kind == Kind::kInertia; });
}

ColumnSet Search::set_of(const ColumnSet& more, std::size_t width) const {
  ColumnSet out;
  if (library_.base_friction && base_friction_left_) out.push_back(library_.friction[width]);
  out = joined(out, library_.base);
  if (spring_added_) out = joined(out, {library_.spring});
  if (mass_added_) out = joined(out, {library_.mass});
  return joined(out, more);
}

double Search::ridge() const {
  double out = 0.0;
  for (const Chosen& c : chosen_) out = std::max(out, c.ridge);
  return out;
}

Search::Judged Search::judge(const ColumnSet& more) const {
  Judged best;
  const bool profiled = library_.base_friction && base_friction_left_;
  for (std::size_t w = 0; w < (profiled ? library_.friction.size() : 1); ++w) {
    ColumnSet set = set_of(more, w);
    Fit fit = evidence_->fit(set, ridge());
    if (fit.beats(best.fit)) best = {std::move(fit), w, std::move(set)};
  }
  return best;
}

ColumnSet Search::chosen_columns() const {
  ColumnSet out;
  for (const Chosen& c : chosen_) out = joined(out, c.candidate.columns);
  return out;
}

std::vector<Regressor> Search::columns_of(const ColumnSet& set) const {
  std::vector<Regressor> out;
  out.reserve(set.size());
  for (const Eigen::Index i : set) out.push_back(library_.at(i));
  return out;
}

Floor Search::floor_of(const ColumnSet& more) const {
  const Judged judged = judge(more);
  if (!judged.fit.ok) return {};
  return surrogate_floor(
      records_, {columns_of(judged.set), judged.fit.theta, columns_of(library_.friction), ridge()});
}

/// The way to write sign v that a fit has of the base's friction.
bool Search::is_friction(Eigen::Index column, const Judged& judged) const {
  return library_.base_friction && column == library_.friction[judged.width];
}

bool Search::can_add(const Candidate& candidate) const {
  return std::none_of(chosen_.begin(), chosen_.end(), [&](const Chosen& c) {
    return c.candidate.effect == candidate.effect ||
           (is_memory(c.candidate.effect) && is_memory(candidate.effect));
  });
}

std::vector<std::string> Search::terms() const {
  std::vector<std::string> out = library_.base_terms;
  if (spring_added_) out.emplace_back("linear spring");
  if (mass_added_) out.emplace_back("moving mass");
  for (const Chosen& c : chosen_) out.push_back(c.candidate.effect);
  return out;
}

void Search::finish_step() {
  chosen_.back().step.held_out_after = error();
  chosen_.back().step.terms = terms();
}

void Search::choose(Candidate candidate, double before_nmse, double gain, double t) {
  Chosen chosen;
  chosen.step.effect = candidate.effect;
  chosen.candidate = std::move(candidate);
  chosen.step.held_out_before = before_nmse;
  chosen.step.gain = gain;
  chosen.step.block_t = t;
  chosen_.push_back(std::move(chosen));
}

/// A linear term that belongs to the rig rather than to the damper stays where it helps.
void Search::try_linear(bool& added) {
  if (added) return;
  const double without = error();
  added = true;
  added = error() < (1.0 - kNeeded) * without;
}

/// Neither is less than nothing: a negative one would only help the fit.
void Search::try_mass() {
  try_linear(mass_added_);
  mass_added_ = mass_added_ && judge_chosen().of(library_.mass).value > 0.0;
}

/// A spring that carries most of the force is no effect that a damper lacks: effects are looked for
/// beside it.
void Search::take_dominant_spring() {
  const Judged without = judge({});
  const Judged with = judge({library_.spring});
  if (!with.fit.ok || with.fit.held_out_nmse > kDominantSpring * without.fit.held_out_nmse) return;
  spring_added_ = true;
  notes_.push_back(
      fmt::format("A linear spring, which the base model does not have, was added first: held-out "
                  "rrse {:.3f} -> {:.3f}. To have it in the base: [model] stiffness = \"identify\"",
                  std::sqrt(without.fit.held_out_nmse), std::sqrt(with.fit.held_out_nmse)));
}

/// Where the widest law of friction is the best, still wider ones, which are hardly another thing
/// than viscous damping, have to be clearly better.
void Search::widen() {
  if (!library_.base_friction || !base_friction_left_) return;
  const Judged now = judge(beside_both());
  const auto width_of = [&](std::size_t i) { return library_.at(library_.friction[i]).a; };
  for (std::size_t i = 0; i < library_.friction.size(); ++i)
    if (!now.fit.ok || width_of(i) > width_of(now.width)) return;
  const std::size_t before = library_.friction.size();
  for (const double a :
       ratios(width_of(now.width), kWidestOfAll * scale_.velocity_mps, kFrictionWidthRatio))
    library_.friction.push_back(library_.add({Kind::kSign, kFrictionWidthRatio * a, 0.0}));
  evaluate_columns();
  if (judge(beside_both()).fit.held_out_nmse > kClearlyWider * now.fit.held_out_nmse)
    library_.friction.resize(before);
}

/// A smooth law of friction between two widths of the grid would leave what looks like an effect.
void Search::refine_width() {
  widen();
  double ratio = kFrictionWidthRatio;
  for (int round = 0; round < kWidthRounds; ++round) {
    if (!library_.base_friction || !base_friction_left_) return;
    const Judged now = judge(beside_both());
    if (!now.fit.ok) return;
    const Regressor best = library_.at(library_.friction[now.width]);
    if (!is_smooth(best, scale_)) return;
    ratio = std::sqrt(ratio);
    for (const double a : {best.a / ratio, best.a * ratio})
      library_.friction.push_back(library_.add({Kind::kSign, a, 0.0}));
    evaluate_columns();
  }
}

void Search::backward() {
  for (std::size_t i = 0; chosen_.size() > 1 && i < chosen_.size();) {
    const double with = error();
    const Chosen removed = chosen_[i];
    if (is_memory(removed.candidate.effect) || removed.candidate.columns.empty()) {
      ++i;
      continue;
    }
    chosen_.erase(chosen_.begin() + static_cast<std::ptrdiff_t>(i));
    const Judged without = judge_chosen();
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
void Search::count_noise(Explanation& out) const {
  if (filtered() || out.is_complete() || !alike_.empty()) return;
  const Remainder left = what_is_left(records_, out.final);
  if (!left.is_like_noise() || left.nmse < out.final.floor_nmse) return;
  ColumnSet all(library_.columns.size());
  std::iota(all.begin(), all.end(), 0);
  const Fit rich = evidence_->fit(all, kRichRidge);
  if (!rich.ok || rich.held_out_nmse < kUntouched * out.final.fit.held_out_nmse) return;
  out.final.floor_nmse = left.nmse;
  out.final.floor_noise_share = 1.0;
  out.notes.push_back(fmt::format(
      "What is left away from the reversals, {:.4g} N rms, is Gaussian, as loud at any time and "
      "speed, and nothing that the motion predicts: it counts as noise of the force, though it is "
      "not white.",
      left.rms_n));
}

Explanation Search::run() {
  Explanation out;
  for (const Series& s : records_) out.records.push_back(s.record);
  out.whole_records = evidence_->folds() == records_.size();
  if (filtered()) out.filter_hz = records_.front().config.corner_hz;
  describe(out.base, judge({}));
  if (!library_.base_spring) take_dominant_spring();
  if (library_.wants_impacts) leave_impacts_out();
  do refine_width();
  while (chosen_.size() < kMostSteps && forward());
  backward();
  spring_added_ = false;
  if (!library_.base_spring) try_linear(spring_added_);
  mass_added_ = false;
  if (!filtered()) try_mass();
  const Judged now = judge_chosen();
  describe_steps(now);
  out.rejected = rejected_;
  out.alike = alike_;
  describe(out.final, now);
  for (const Chosen& c : chosen_) {
    out.final.skew_s += c.skew_s;
    if (c.path.hz > 0.0) out.final.path = c.path;
  }
  out.notes = notes_;
  const Floor floor = floor_of(chosen_columns());
  out.final.floor_nmse = floor.nmse;
  out.final.floor_noise_share = floor.noise_share;
  count_noise(out);
  for (const Chosen& c : chosen_) {
    out.steps.push_back(c.step);
    for (const Parameter& p : c.step.parameters) add_once(p, out.final.parameters);
  }
  return out;
}

}  // namespace dampline::app::rig

// SPDX-License-Identifier: MIT
#include "app/rig/result.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "app/error.hpp"
#include "app/run/trust.hpp"
#include "app/text/format.hpp"

namespace dampline::app::rig {
namespace {

/// Effects of a base that have one value or one for each direction, in the order of results.
struct BaseEffect {
  std::string_view name;
  const char* kind;
  core::Branches core::Terms::*term;
  core::Branches branches;
};
constexpr std::array kBaseEffects{
    BaseEffect{"coulomb", "coulomb", &core::Terms::coulomb, core::Branches::kCommon},
    BaseEffect{"asymmetric_coulomb", "coulomb", &core::Terms::coulomb, core::Branches::kSeparate},
    BaseEffect{"viscous", "viscous", &core::Terms::viscous, core::Branches::kCommon},
    BaseEffect{"asymmetric_viscous", "viscous", &core::Terms::viscous, core::Branches::kSeparate}};

/// Effects that a base may have beside the terms.
constexpr std::array<std::string_view, 10> kSearched{"quadratic_damping",
                                                     "progressive_damping",
                                                     "progressive_friction",
                                                     "stribeck",
                                                     "presliding_hysteresis",
                                                     "backlash",
                                                     "bump_stop",
                                                     "cubic_stiffness",
                                                     "quadratic_stiffness",
                                                     "asymmetric_stiffness"};

bool is_searched(std::string_view name) {
  return std::find(kSearched.begin(), kSearched.end(), name) != kSearched.end();
}

void add_effect(const std::string& name, core::Terms& terms) {
  if (is_searched(name)) return;
  if (name == "offset_force") {
    terms.offset = true;
    return;
  }
  const auto* const found = std::find_if(kBaseEffects.begin(), kBaseEffects.end(),
                                         [&](const BaseEffect& e) { return e.name == name; });
  if (found == kBaseEffects.end())
    throw UsageError{fmt::format(
        "[model] base: found \"{}\", expected of a rig: viscous, asymmetric_viscous, coulomb, "
        "asymmetric_coulomb, offset_force, {}",
        name, fmt::join(kSearched, ", "))};
  core::Branches& branches = terms.*(found->term);
  if (branches != core::Branches::kNone && branches != found->branches)
    throw UsageError{fmt::format(
        "[model] base: found both {0} and asymmetric_{0}, expected one of them", found->kind)};
  branches = found->branches;
}

struct Text {
  const char* name;
  const char* unit;
};

/// Indexed by core::Parameter.
constexpr std::array<Text, 10> kTexts{{{"moving_mass", "kg"},
                                       {"stiffness", "N/m"},
                                       {"viscous", "N s/m"},
                                       {"viscous_positive", "N s/m"},
                                       {"viscous_negative", "N s/m"},
                                       {"coulomb", "N"},
                                       {"coulomb_positive", "N"},
                                       {"coulomb_negative", "N"},
                                       {"offset", "N"},
                                       {"slope", "N s/m"}}};

Estimate find(const core::Snapshot& snapshot, core::Parameter parameter) {
  for (std::size_t i = 0; i < snapshot.size; ++i)
    if (snapshot.estimates[i].parameter == parameter) return snapshot.estimates[i].estimate;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  return {kUnknown, kUnknown};
}

constexpr double kSpringMatters = 0.8;  // of the held-out error without one

void fill_parameters(const core::Snapshot& snapshot, RunResult& result) {
  for (std::size_t i = 0; i < snapshot.size; ++i) {
    const core::ParameterEstimate& e = snapshot.estimates[i];
    result.parameters.push_back({parameter_name(e.parameter), e.estimate.value, e.estimate.std,
                                 parameter_unit(e.parameter)});
  }
}

void fill_counts(const core::Counts& c, RunResult& result) {
  result.counts = {{"samples", c.samples},
                   {"gaps", c.gaps},
                   {"lost", c.lost},
                   {"repeated", c.repeated},
                   {"not_finite", c.not_finite},
                   {"blocks_used", c.blocks},
                   {"rows", c.rows},
                   {"rows_still", c.rows_still}};
}

void fill_curve(const core::Curve& curve, RunResult& result) {
  for (std::size_t i = 0; i < curve.size; ++i) {
    const CurvePoint& p = curve.points[i];
    result.curve.push_back({p.velocity_mps, p.force_n, p.std_n, p.samples});
  }
}

std::string asymmetry_text(const core::Snapshot& snapshot) {
  const core::Curve& curve = snapshot.curve;
  double sum = 0.0;
  double level = 0.0;
  for (std::size_t i = 0; i < curve.size; ++i) {
    const CurvePoint& p = curve.points[i];
    const auto share = static_cast<double>(p.samples);
    sum += share * p.force_n;
    level += share * std::abs(p.force_n);
  }
  if (!(level > 0.0)) return "both branches are measured; too little data for the curve";
  return fmt::format(
      "both branches are measured and shown; F(v > 0) + F(v < 0) weighted by samples is {:.2g} % "
      "of "
      "|F|",
      100.0 * sum / level);
}

std::string filter_note(const Findings& f) {
  std::string text = fmt::format(
      "Fitted through a test function with its -3 dB point at {:.3g} Hz: of the force seen through "
      "it "
      "the model leaves rrse {:.3f}, held out {:.3f}. ",
      f.config.corner_hz, std::sqrt(f.snapshot.nmse), std::sqrt(f.snapshot.held_out_nmse));
  text +=
      "The stated errors are those of the raw measured force in time, predicted from the motion";
  if (f.terms.inertia)
    text +=
        fmt::format("; its acceleration is seen through {:.3g} Hz", f.config.prediction_corner_hz);
  return text + ".";
}

std::string velocity_note(const core::Config& config) {
  if (config.velocity_measured) return "Velocity: measured (velocity_mps).";
  return fmt::format("Velocity: derived from the deflection over {} samples.",
                     2 * config.velocity_half_width + 1);
}

std::string spring_note(const Findings& f) {
  if (!f.with_spring || !f.with_spring->valid) return "";
  if (f.with_spring->held_out_nmse > kSpringMatters * f.snapshot.held_out_nmse) return "";
  const double stiffness = find(*f.with_spring, core::Parameter::kStiffness).value;
  return fmt::format(
      "A linear spring of {:.3g} N/m would lower the held-out rrse from {:.3f} to {:.3f}. If the "
      "measured force contains a spring, set stiffness = \"identify\" in [model]; otherwise "
      "friction "
      "with memory (presliding, backlash) looks like this.",
      stiffness, std::sqrt(f.snapshot.held_out_nmse), std::sqrt(f.with_spring->held_out_nmse));
}

void fill_notes(const Findings& f, RunResult& result) {
  for (std::string note : {spring_note(f), filter_note(f), velocity_note(f.config)})
    if (!note.empty()) result.notes.push_back(std::move(note));
}

}  // namespace

core::Terms terms_of(const ModelConfig& model) {
  core::Terms terms;
  terms.coulomb = core::Branches::kNone;
  for (const std::string& name : model.base) add_effect(name, terms);
  terms.inertia = model.inertia == "identify";
  terms.stiffness = model.stiffness == "identify";
  if (!check(terms))
    throw UsageError{
        "[model] base: asymmetric_coulomb and offset_force cannot be told apart, expected one of "
        "them"};
  if (model.base.empty() && !terms.inertia && !terms.stiffness)
    throw UsageError{"[model] base: found no effect, expected at least one"};
  return terms;
}

std::vector<std::string> searched_base(const ModelConfig& model) {
  std::vector<std::string> out;
  std::copy_if(model.base.begin(), model.base.end(), std::back_inserter(out), is_searched);
  return out;
}

std::vector<std::string> term_names(const core::Terms& terms) {
  std::vector<std::string> out;
  if (terms.inertia) out.emplace_back("moving mass");
  if (terms.stiffness) out.emplace_back("linear spring");
  for (const BaseEffect& e : kBaseEffects)
    if (terms.*(e.term) == e.branches) out.emplace_back(e.name);
  if (terms.offset) out.emplace_back("offset_force");
  return out;
}

const char* parameter_name(core::Parameter parameter) noexcept {
  return kTexts[static_cast<std::size_t>(parameter)].name;
}
const char* parameter_unit(core::Parameter parameter) noexcept {
  return kTexts[static_cast<std::size_t>(parameter)].unit;
}

History::History(const core::Terms& terms, const core::Snapshot& last, std::int64_t ticks,
                 double rate_hz)
    : terms_{terms},
      interval_{std::max<std::int64_t>(1, ticks / kRows)},
      next_{interval_},
      rate_hz_{rate_hz} {
  for (std::size_t i = 0; i < last.size; ++i) {
    parameters_.push_back(last.estimates[i].parameter);
    convergence_.names.emplace_back(parameter_name(parameters_.back()));
    convergence_.units.emplace_back(parameter_unit(parameters_.back()));
  }
}

void History::take(std::int64_t tick, const core::Identifier& identifier) {
  if (tick < next_) return;
  while (next_ <= tick) next_ += interval_;
  const core::Snapshot snapshot = identifier.snapshot(terms_);
  if (!snapshot.valid || snapshot.size < parameters_.size()) return;
  Convergence::Row row{static_cast<double>(tick) / rate_hz_, {}};
  for (const core::Parameter parameter : parameters_)
    row.estimates.push_back(find(snapshot, parameter));
  convergence_.rows.push_back(std::move(row));
}

Excerpt::Excerpt(double still_mps, double rate_hz)
    : still_mps_{still_mps},
      rate_hz_{rate_hz},
      stride_{static_cast<std::int64_t>(std::ceil(kLengthSeconds * rate_hz / kMost))} {}

void Excerpt::take(const core::Prediction& prediction) {
  if (!started_) {
    if (std::abs(prediction.velocity_mps) <= still_mps_) return;
    started_ = true;
    first_tick_ = prediction.tick;
  }
  const std::int64_t since = prediction.tick - first_tick_;
  if (since % stride_ != 0 || static_cast<double>(since) > kLengthSeconds * rate_hz_) return;
  const double time_s = static_cast<double>(prediction.tick) / rate_hz_;
  motion_.push_back({time_s, prediction.deflection_m, prediction.velocity_mps});
  force_.push_back({time_s, prediction.velocity_mps, prediction.measured_n, prediction.fitted_n});
}

void Excerpt::move_to(RunResult& result) {
  result.motion = std::move(motion_);
  result.force = std::move(force_);
}

RunResult result_of(const Findings& f) {
  RunResult result;
  result.kind = "rig";
  result.model = term_names(f.terms);
  fill_parameters(f.snapshot, result);
  fill_counts(f.snapshot.counts, result);
  fill_curve(f.snapshot.curve, result);
  result.fit = {f.errors.nmse, std::sqrt(f.errors.nmse), f.errors.held_out_nmse, {}, {}};
  result.asymmetry = asymmetry_text(f.snapshot);
  const auto samples = static_cast<double>(f.snapshot.counts.samples);
  result.excitation = 1.0 - static_cast<double>(f.still_samples) / samples;
  result.sample_rate_hz = Estimate{f.config.sample_rate_hz, 0.0};
  result.latency_s = f.latency_samples / f.config.sample_rate_hz;
  result.duration_s = static_cast<double>(f.ticks) / f.config.sample_rate_hz;
  fill_notes(f, result);
  judge_trust(nullptr, result);
  return result;
}

}  // namespace dampline::app::rig

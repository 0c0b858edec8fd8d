// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/explanation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "app/diagnosis/truck/law.hpp"
#include "app/diagnosis/truck/verdict.hpp"
#include "app/text/summary.hpp"

namespace dampline::app {

namespace {

std::vector<std::string> terms_of(const effect::Explanation& e, std::size_t steps) {
  std::vector<std::string> terms{"linear spring", "coulomb"};
  for (std::size_t i = 0; i < e.base_count; ++i)
    terms.emplace_back(effect::name_of(e.base_model.effect[i].effect));
  for (std::size_t i = 0; i < steps; ++i)
    terms.emplace_back(effect::name_of(e.step[i].chosen.effect));
  return terms;
}

Parameter parameter(const char* name, const Estimate& estimate, const char* unit) {
  return {name, estimate.value, estimate.std, unit};
}

Parameter parameter_of(const effect::EffectParameter& p) {
  return {p.name, p.estimate.value, p.estimate.std, p.unit, p.twin, p.correlation};
}

void append(const std::vector<Parameter>& more, std::vector<Parameter>& out) {
  out.insert(out.end(), more.begin(), more.end());
}

std::vector<JudgedCandidate> runners_up_of(const effect::Step& step) {
  std::vector<JudgedCandidate> out;
  for (std::size_t r = 0; r < step.runner_up_count; ++r) {
    const effect::RunnerUp& u = step.runner_up[r];
    out.push_back({effect::name_of(u.effect), u.held_out_nmse, u.gain, u.block_t});
  }
  return out;
}

/// The best of the round that added nothing.
std::vector<JudgedCandidate> rejected_of(const effect::Explanation& e) {
  const effect::Step& best = e.rejected;
  if (best.chosen.count == 0) return {};
  std::vector<JudgedCandidate> out{
      {effect::name_of(best.chosen.effect), best.held_out_nmse_after, best.gain, best.block_t}};
  for (const JudgedCandidate& c : runners_up_of(best)) out.push_back(c);
  return out;
}

Step step_of(const effect::Explanation& e, std::size_t i) {
  const effect::Step& step = e.step[i];
  Step out;
  out.effect = effect::name_of(step.chosen.effect);
  out.terms = terms_of(e, i + 1);
  out.held_out_before = step.restated_before;
  out.held_out_after = step.restated_after;
  out.gain = 1.0 - step.restated_after / step.restated_before;
  out.block_t = step.block_t;
  for (std::size_t p = 0; p < step.parameter_count; ++p)
    out.parameters.push_back(parameter_of(step.parameter[p]));
  out.runners_up = runners_up_of(step);
  return out;
}

/// A parameter that changed; its errors are those of the base, less its gain.
Step drift_step(const Explained& explained) {
  const DriftFinding& drift = *explained.identified.faults.drift;
  Step out;
  out.effect = "time_drift";
  out.terms = terms_of(explained.explanation, 0);
  out.terms.emplace_back("time_drift");
  out.held_out_before = explained.explanation.base.held_out_nmse;
  out.held_out_after = left_nmse(explained);
  out.gain = drift.gain;
  const std::string name = "time_drift_" + drift.parameter;
  out.parameters.push_back(parameter(name.c_str(), drift.change_percent, "%"));
  // A time that is as likely anywhere in its interval.
  if (drift.step)
    out.parameters.push_back(
        parameter("time_drift_time", {drift.time_s, 0.29 * drift.interval_s}, "s"));
  return out;
}

/// The other truck; what is left with it is what the base leaves of the force of both.
Step other_step(const Explained& explained) {
  const OtherTruck& other = *explained.other;
  Step out;
  out.effect = "other_truck";
  out.terms = terms_of(explained.explanation, 0);
  out.terms.emplace_back("other_truck");
  out.held_out_before = explained.without_other_nmse;
  out.held_out_after = base_error(explained.explanation);
  out.gain = 1.0 - out.held_out_after / out.held_out_before;
  out.parameters = {parameter("other_truck_mass", other.mass_kg, "kg"),
                    parameter("other_truck_delay", other.delay_s, "s")};
  return out;
}

ModelFound base_of(const Explained& explained) {
  const effect::Explanation& e = explained.explanation;
  double error = explained.drifts ? e.base.held_out_nmse : base_error(e);
  if (explained.other) error = explained.without_other_nmse;
  ModelFound out{terms_of(e, 0), error, {}, {}};
  out.parameters = explained.identified.parameters;
  if (out.parameters.empty())
    out.parameters = {parameter("coulomb", e.base_coulomb_n, "N"),
                      parameter("stiffness", e.base_stiffness_npm, "N/m")};
  return out;
}

/// Friction and spring beside what was added to them; as the base where that is no law.
ModelFound final_of(const Explained& explained, const Explanation& told) {
  const effect::Explanation& e = explained.explanation;
  ModelFound out = told.base;
  out.held_out_nmse = left_nmse(explained);
  if (told.steps.empty()) return out;
  out.terms = told.steps.back().terms;
  if (!explained.drifts) {
    out.parameters = {parameter("coulomb", e.final_coulomb_n, "N"),
                      parameter("stiffness", e.final_stiffness_npm, "N/m")};
    if (e.base_count > 0) out.parameters.push_back(parameter("viscous", final_viscous(e), "N s/m"));
  }
  for (const Step& step : told.steps) append(step.parameters, out.parameters);
  return out;
}

/// Something real is left that has no name.
bool is_unknown(effect::Conclusion conclusion) {
  return conclusion == effect::Conclusion::kUnexplained ||
         conclusion == effect::Conclusion::kPartlyExplained;
}

/// Beside a gap, or friction with a memory, what changed is not told: a gap that grows looks like a
/// mass.
std::optional<DriftFinding> drift_of(const Explained& explained) {
  std::optional<DriftFinding> out = explained.identified.faults.drift;
  const bool remembers = any_of_steps(explained.explanation, [](const effect::Step& step) {
    return effect::has_memory(step.chosen.effect);
  });
  if (out && !explained.drifts && remembers) out->parameter = DriftFinding::kNotTold;
  return out;
}

/// A frame that follows its wheelsets otherwise from some moment on may be late, or have a gap or
/// softer friction since then.
std::string alike_of(const Explained& explained) {
  for (const FaultFinding& f : explained.identified.faults.list)
    if (f.name == "timing_step" && f.channel == "frame")
      return fmt::format(
          "timing_step, or backlash or presliding_hysteresis that begins or ends at {:.0f} s",
          f.time_s);
  return {};
}

Explanation found_in(const Explained& explained) {
  const effect::Explanation& e = explained.explanation;
  Explanation out;
  const effect::Conclusion conclusion = conclusion_of(explained);
  out.verdict = effect::name_of(conclusion);
  out.known = {e.floor_nmse > 0.0, is_unknown(conclusion), explained.withheld, !is_possible(e)};
  out.known.frame_gain = explained.frame_gain;
  out.unknown = !explained.withheld && !explained.drifts && is_unknown(e.conclusion);
  out.base = base_of(explained);
  if (explained.other) out.steps.push_back(other_step(explained));
  for (std::size_t i = 0; i < e.step_count; ++i) {
    out.steps.push_back(step_of(e, i));
    if (explained.other) out.steps.back().terms.emplace_back("other_truck");
  }
  if (explained.drifts) out.steps.push_back(drift_step(explained));
  out.final = final_of(explained, out);
  out.rejected = rejected_of(e);
  out.floor_nmse = e.floor_nmse;
  out.left_over_floor = left_over_floor(explained);
  out.law_incomplete = out.left_over_floor > effect::kIncompleteAbove;
  out.force = "moving mass times the frame's deceleration, over 1 Hz";
  out.validation = explained.validation;
  out.faults = explained.identified.faults.list;
  out.notes = explained.notes;
  if (const auto drift = drift_of(explained); drift && !explained.drifts)
    out.notes.push_back(drift_text(*drift));
  out.alike = alike_of(explained);
  out.signature = explained.signature;
  out.channels = {"frame", "wheelset1", "wheelset2"};
  return out;
}

}  // namespace

Explanation conclude(const Explained& explained, RunResult& result) {
  Explanation out = found_in(explained);
  const effect::Explanation& e = explained.explanation;
  if (e.step_count > 0 || explained.other) {
    put_law(e, result.curve);
    std::erase_if(result.notes,
                  [](const std::string& note) { return note.starts_with("A viscous part"); });
    if (!explained.convergence.rows.empty()) result.convergence = explained.convergence;
  }
  result.notes.insert(result.notes.end(), explained.notes.begin(), explained.notes.end());
  result.faults.drift = drift_of(explained);
  out.known.unsteady = result.faults.drift && !explained.drifts &&
                       result.faults.drift->parameter != DriftFinding::kNotTold;
  for (std::string& warning : result.warnings)
    if (result.faults.drift && warning.starts_with(kNotConstant))
      warning = drift_warning(*result.faults.drift, "record");
  put_final(out, result);
  result.evidence.explanation = to_json(out);
  return out;
}

Explanation told(const Explained& explained) {
  RunResult result = explained.identified;
  result.kind = "truck";
  return conclude(explained, result);
}

}  // namespace dampline::app

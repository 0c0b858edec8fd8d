// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/explanation_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/diagnosis/common/json.hpp"
#include "app/diagnosis/truck/verdict.hpp"

namespace dampline::app {

namespace {

using Json = nlohmann::ordered_json;
using effect::Explanation;
using effect::Step;

Json parameter(const char* name, const Estimate& estimate, const char* unit) {
  return {{"name", name}, {"value", estimate.value}, {"std", estimate.std}, {"unit", unit}};
}

Json parameters_of(const Step& step) {
  Json list = Json::array();
  for (std::size_t i = 0; i < step.parameter_count; ++i) {
    const effect::EffectParameter& p = step.parameter[i];
    list.push_back(parameter(p.name, p.estimate, p.unit));
    if (p.correlation == 0.0) continue;
    list.back()["correlation"] = {{"with", p.twin}, {"value", p.correlation}};
    list.back()["separable"] = std::abs(p.correlation) <= effect::kInseparable;
  }
  return list;
}

/// Base or final model.
Json model(const Explanation& e, bool final) {
  const double held_out_nmse = final ? e.final.held_out_nmse : base_error(e);
  Json list = Json::array();
  list.push_back(parameter("coulomb", final ? e.final_coulomb_n : e.base_coulomb_n, "N"));
  list.push_back(
      parameter("stiffness", final ? e.final_stiffness_npm : e.base_stiffness_npm, "N/m"));
  const std::size_t steps = final ? e.step_count : 0;
  for (std::size_t i = 0; i < steps; ++i)
    for (const Json& p : parameters_of(e.step[i])) list.push_back(p);
  return {{"terms", terms_of(e, steps)},
          {"held_out_nmse", held_out_nmse},
          {"held_out_rrse", std::sqrt(held_out_nmse)},
          {"parameters", list}};
}

std::vector<JudgedCandidate> runners_up_of(const Step& step) {
  std::vector<JudgedCandidate> out;
  for (std::size_t r = 0; r < step.runner_up_count; ++r) {
    const effect::RunnerUp& u = step.runner_up[r];
    out.push_back({effect::name_of(u.effect), u.held_out_nmse, u.gain, u.block_t});
  }
  return out;
}

/// The best of the round that added nothing.
std::vector<JudgedCandidate> rejected_of(const Explanation& e) {
  const Step& best = e.rejected;
  if (best.chosen.count == 0) return {};
  std::vector<JudgedCandidate> out{
      {effect::name_of(best.chosen.effect), best.held_out_nmse_after, best.gain, best.block_t}};
  for (const JudgedCandidate& c : runners_up_of(best)) out.push_back(c);
  return out;
}

Json known(double value) { return value > 0.0 ? Json(value) : Json(nullptr); }

/// "like X, law incomplete", where more is left than a complete law would leave.
Json note_of(const char* effect, double over_floor) {
  if (over_floor <= effect::kIncompleteAbove) return nullptr;
  return fmt::format("like {}, law incomplete", effect);
}

Json step_json(const Explanation& e, std::size_t i) {
  const Step& step = e.step[i];
  const double ratio = floor_ratio(e);
  return {{"effect", effect::name_of(step.chosen.effect)},
          {"terms", terms_of(e, i + 1)},
          {"held_out_nmse_before", step.restated_before},
          {"held_out_nmse_after", step.restated_after},
          {"parameters", parameters_of(step)},
          {"evidence",
           {{"gain", 1.0 - step.restated_after / step.restated_before},
            {"block_t", step.block_t},
            {"left_over_floor", known(ratio)}}},
          {"note", note_of(effect::name_of(step.chosen.effect), ratio)},
          {"runners_up", judged_json(runners_up_of(step))}};
}

Json faults_of(const DataFaults& faults) {
  Json list = Json::array();
  for (const FaultFinding& f : faults.list)
    list.push_back({{"name", f.name},
                    {"channel", f.channel},
                    {"time_s", f.time_s},
                    {"size", f.size},
                    {"unit", f.unit}});
  return list;
}

/// Something real is left that has no name.
bool is_unknown(const Explanation& e) {
  return e.conclusion == effect::Conclusion::kUnexplained ||
         e.conclusion == effect::Conclusion::kPartlyExplained;
}

Json drift_parameters(const DriftFinding& drift) {
  Json list = Json::array();
  list.push_back(parameter(("time_drift_" + drift.parameter).c_str(), drift.change_percent, "%"));
  if (drift.step)
    list.push_back(parameter("time_drift_time", {drift.time_s, 0.29 * drift.interval_s}, "s"));
  return list;
}

std::vector<std::string> drift_terms(const Explanation& e) {
  auto terms = terms_of(e, 0);
  terms.emplace_back("time_drift");
  return terms;
}

/// A parameter that changed, as the one step; its errors are those of the base, less its gain.
Json drift_step(const Explained& explained) {
  const Explanation& e = explained.explanation;
  const DriftFinding& drift = *explained.identified.faults.drift;
  const double ratio = left_over_floor(explained);
  return {{"effect", "time_drift"},
          {"terms", drift_terms(e)},
          {"held_out_nmse_before", e.base.held_out_nmse},
          {"held_out_nmse_after", left_nmse(explained)},
          {"parameters", drift_parameters(drift)},
          {"evidence",
           {{"gain", drift.gain},
            {"kind", drift.step ? "step" : "drift"},
            {"left_over_floor", known(ratio)}}},
          {"note", note_of("time_drift", ratio)},
          {"runners_up", Json::array()}};
}

/// The base with a parameter that changes; friction and spring are those of the whole record.
Json drifting_model(const Explained& explained) {
  Json out = model(explained.explanation, false);
  out["terms"] = drift_terms(explained.explanation);
  out["held_out_nmse"] = left_nmse(explained);
  out["held_out_rrse"] = std::sqrt(left_nmse(explained));
  for (const Json& p : drift_parameters(*explained.identified.faults.drift))
    out["parameters"].push_back(p);
  return out;
}

}  // namespace

std::vector<std::string> terms_of(const Explanation& e, std::size_t steps) {
  std::vector<std::string> terms{"linear spring", "coulomb"};
  for (std::size_t i = 0; i < e.base_count; ++i)
    terms.emplace_back(effect::name_of(e.base_model.effect[i].effect));
  for (std::size_t i = 0; i < steps; ++i)
    terms.emplace_back(effect::name_of(e.step[i].chosen.effect));
  return terms;
}

std::string to_json(const Explained& explained) {
  const Explanation& e = explained.explanation;
  Json steps = Json::array();
  for (std::size_t i = 0; i < e.step_count; ++i) steps.push_back(step_json(e, i));
  Json validation = Json::array();
  for (const Validated& v : explained.validation)
    validation.push_back({{"record", v.record},
                          {"rrse_before", std::sqrt(v.nmse_before)},
                          {"rrse_after", std::sqrt(v.nmse_after)},
                          {"nmse_before", v.nmse_before},
                          {"nmse_after", v.nmse_after}});
  const bool drifts = explained.drifts;
  if (drifts) steps.push_back(drift_step(explained));
  const bool unknown = !explained.withheld && !drifts && is_unknown(e);
  if (unknown && e.step_count == 0)
    steps.push_back(unknown_step(terms_of(e, 0), e.base.held_out_nmse, explained.signature));
  const Json json{{"verdict", effect::name_of(conclusion_of(explained))},
                  {"base", model(e, false)},
                  {"steps", steps},
                  {"final", drifts ? drifting_model(explained) : model(e, true)},
                  {"rejected", judged_json(rejected_of(e))},
                  {"floor_nmse", known(e.floor_nmse)},
                  {"left_over_floor", known(left_over_floor(explained))},
                  {"validation", validation},
                  {"faults", faults_of(explained.identified.faults)},
                  {"force", "moving mass times the frame's deceleration, over 1 Hz"},
                  {"signature", explained.signature.rms_n > 0.0
                                    ? signature_json(explained.signature,
                                                     {"frame", "wheelset1", "wheelset2"}, unknown)
                                    : Json::object()}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace dampline::app

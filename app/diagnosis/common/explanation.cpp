// SPDX-License-Identifier: MIT
#include "app/diagnosis/common/explanation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/config/config.hpp"
#include "app/run/json.hpp"
#include "app/text/format.hpp"
#include "app/text/summary.hpp"

namespace dampline::app {
namespace {

using Json = nlohmann::ordered_json;

Json parameters_json(const std::vector<Parameter>& parameters) {
  Json out = Json::array();
  for (const Parameter& p : parameters) {
    Json& added = out.emplace_back(parameter_json(p.name, {p.value, p.std}, p.unit));
    if (p.correlation == 0.0) continue;
    added["correlation"] = {{"with", p.twin}, {"value", p.correlation}};
    added["separable"] = is_separable(p);
  }
  return out;
}

/// Mean over the records of what each one's error is.
double mean_rrse(const ModelFound& model) {
  if (model.records.empty()) return std::sqrt(model.held_out_nmse);
  double sum = 0.0;
  for (const auto& [record, nmse] : model.records) sum += std::sqrt(nmse);
  return sum / static_cast<double>(model.records.size());
}

Json model_json(const ModelFound& model) {
  Json out{{"terms", model.terms},
           {"held_out_nmse", model.held_out_nmse},
           {"held_out_rrse", std::sqrt(model.held_out_nmse)},
           {"parameters", parameters_json(model.parameters)}};
  if (model.records.empty()) return out;
  out["held_out_rrse_mean"] = mean_rrse(model);
  out["records"] = Json::array();
  for (const auto& [record, nmse] : model.records)
    out["records"].push_back({{"record", record}, {"held_out_rrse", std::sqrt(nmse)}});
  return out;
}

Json known(double value) { return value > 0.0 ? Json(value) : Json(nullptr); }

std::string note_of(const std::string& effect) {
  return fmt::format("like {}, law incomplete", effect);
}

Json judged_json(const std::vector<JudgedCandidate>& candidates) {
  Json out = Json::array();
  for (const JudgedCandidate& c : candidates)
    out.push_back({{"effect", c.effect},
                   {"held_out_nmse", c.held_out_nmse},
                   {"gain", c.gain},
                   {"block_t", c.block_t}});
  return out;
}

Json step_json(const Explanation& e, const Step& step) {
  return {{"effect", step.effect},
          {"terms", step.terms},
          {"held_out_nmse_before", step.held_out_before},
          {"held_out_nmse_after", step.held_out_after},
          {"parameters", parameters_json(step.parameters)},
          {"evidence",
           {{"of", step.of},
            {"gain", step.gain},
            {"block_t", known(std::abs(step.block_t))},
            {"left_over_floor", known(e.left_over_floor)}}},
          {"note", e.law_incomplete ? Json(note_of(step.effect)) : Json(nullptr)},
          {"runners_up", judged_json(step.runners_up)}};
}

/// The step of a residual that is real and that nothing explains: it changes nothing.
Json unknown_step(const Explanation& e) {
  return {{"effect", "unknown"},
          {"terms", e.base.terms},
          {"held_out_nmse_before", e.base.held_out_nmse},
          {"held_out_nmse_after", e.base.held_out_nmse},
          {"parameters", Json::array()},
          {"evidence", {{"signature", describe(e.signature)}}},
          {"runners_up", Json::array()}};
}

Json validated_json(const Validated& v) {
  Json out{{"record", v.record},
           {"rrse_before", v.rrse_before},
           {"rrse_after", v.rrse_after},
           {"nmse_before", v.rrse_before * v.rrse_before},
           {"nmse_after", v.rrse_after * v.rrse_after}};
  if (v.start_m) out["start_slip_m"] = *v.start_m;
  if (!v.has_reference) return out;
  out["rrse_reference"] = v.reference_rrse;
  out["rrse_after_where_reference"] = v.same_rows_rrse;
  return out;
}

Json fault_json(const FaultFinding& f) {
  return {{"name", f.name},
          {"channel", f.channel},
          {"time_s", f.time_s},
          {"size", f.size},
          {"unit", f.unit}};
}

/// Null where it was not tried.
Json free_run_json(const FreeRunError& f) {
  if (f.segments == 0) return nullptr;
  return {{"segments", f.segments},
          {"segment_s", f.segment_s},
          {"nmse_by_equations", known(f.nmse_of_equations)},
          {"held_out_nmse", f.nmse_of_motion},
          {"residual_m", f.residual_m},
          {"noise_m", f.noise_m},
          {"density_ratio", known(f.density_ratio.value_or(0.0))},
          {"density_ratio_of_noise", known(f.density_ratio_of_noise.value_or(0.0))},
          {"followed", f.followed},
          {"agrees_with_equations", f.agree},
          {"refined", f.by_motion},
          {"has_own_figures", f.has_figures}};
}

const char* symmetry_of(const Signature& s) {
  if (s.odd_share > Signature::kMostly) return "odd";
  return s.odd_share < 1.0 - Signature::kMostly ? "even" : "mixed";
}

/// What is left.
Json signature_json(const Explanation& e) {
  const Signature& s = e.signature;
  if (!(s.rms_n > 0.0)) return Json::object();
  Json coherence = Json::array();
  for (std::size_t c = 0; c < e.channels.size(); ++c)
    coherence.push_back({{"channel", e.channels[c]}, {"coherence", s.coherence[c]}});
  return {{"effect", e.unknown ? Json("unknown") : Json(nullptr)},
          {"rms_n", s.rms_n},
          {"memoryless", s.memoryless()},
          {"memory", s.has_memory()},
          {"symmetry", s.memoryless() ? Json(symmetry_of(s)) : Json(nullptr)},
          {"surface_share", s.surface_share},
          {"surface_odd_share", s.odd_share},
          {"travel_share", s.travel_share},
          {"frequency_hz", {{"low", s.low_hz}, {"peak", s.peak_hz}, {"high", s.high_hz}}},
          {"time_s", {{"worst", s.worst_time_s}, {"worst_over_median", s.worst_share}}},
          {"coherence", coherence},
          {"text", describe(s)}};
}

template <class T, class Make>
Json list_of(const std::vector<T>& items, Make make) {
  Json out = Json::array();
  for (const T& item : items) out.push_back(make(item));
  return out;
}

std::string lines_of(const std::vector<Parameter>& parameters) {
  std::string text;
  for (const Parameter& p : parameters) {
    const QuantityText q = format_quantity(p.value, p.std);
    text += fmt::format("    {:<36} {}{}{}{}", p.name, q.value, q.std.empty() ? "" : " ± " + q.std,
                        p.unit.empty() ? "" : " ", p.unit);
    text += is_separable(p) ? "\n"
                            : fmt::format(", not separable here from {} (correlation {:.3f})\n",
                                          p.twin, p.correlation);
  }
  return text;
}

std::string error_text(double nmse) {
  return fmt::format("{:.4g} (rrse {:.3f})", nmse, std::sqrt(nmse));
}

std::string model_text(const char* name, const ModelFound& model) {
  const std::string mean =
      model.records.size() > 1
          ? fmt::format(", rrse {:.3f} in the mean of the records", mean_rrse(model))
          : "";
  return fmt::format("{:<6} held-out nmse {}{}: {}\n", name, error_text(model.held_out_nmse), mean,
                     fmt::join(model.terms, ", ")) +
         lines_of(model.parameters);
}

const char* sentence(const Explanation& e) {
  if (e.known.withheld) return "the data have faults that look like effects: none is named";
  if (e.known.impossible)
    return "friction or spring come out negative, as no truck has them: no law is stated";
  if (!e.alike.empty() && e.steps.empty())
    return "effects that this record cannot tell apart explain what is left alike: none is named";
  if (e.verdict == "complete") return "no effect of the library improves the model";
  if (e.verdict == "explained") return "the model lacked what follows";
  if (e.verdict == "partly_explained") return "the model lacked what follows, and something more";
  return "something is left that no effect of the library explains";
}

std::string step_text(const Step& step) {
  std::string text = fmt::format("+ {}: held-out nmse {}{} -> {}", step.effect,
                                 step.of == "force_n" ? "" : "of " + step.of + " ",
                                 error_text(step.held_out_before), error_text(step.held_out_after));
  text += (step.block_t != 0.0 ? fmt::format(", t {:.1f}\n", step.block_t) : "\n") +
          lines_of(step.parameters);
  for (const JudgedCandidate& c : step.runners_up)
    text += fmt::format("    {:<36} {} {:.4g}\n", "next best", c.effect, c.held_out_nmse);
  return text;
}

std::string floor_text(const Explanation& e) {
  std::string text = "floor  not known: whether more is left than sensors make is not judged\n";
  if (e.floor_nmse > 0.0)
    text = fmt::format("floor  nmse {:.4g} by {}; left: {:.2f} times that\n", e.floor_nmse,
                       e.floor_by, e.left_over_floor);
  if (e.law_incomplete && !e.steps.empty())
    text += fmt::format("       {}\n", note_of(e.steps.front().effect));
  if (!e.alike.empty()) text += fmt::format("alike  {}\n", e.alike);
  return text;
}

std::string free_run_text(const FreeRunError& f) {
  if (f.segments == 0) return "";
  const char* kept = f.by_motion ? "the law is refined by it"
                     : f.has_figures
                         ? "the equations' figures stay, but predict --free-run has these"
                         : "the equations are at least as certain, and stay";
  std::string text = fmt::format(
      "free run of {} x {:.3g} s by the force alone: off by {:.4g} m rms, held-out nmse {} ({:.4g} "
      "by the equations); the deflection's noise is {:.2g} m",
      f.segments, f.segment_s, f.residual_m, error_text(f.nmse_of_motion), f.nmse_of_equations,
      f.noise_m);
  if (f.density_ratio)
    text +=
        fmt::format("; where the motion is, {:.3g} times as much is left as beside it (noise: {})",
                    *f.density_ratio,
                    f.density_ratio_of_noise
                        ? fmt::format("1, with the force's {:.3g}", *f.density_ratio_of_noise)
                        : "1");
  return fmt::format("{}: {}\n", text, kept);
}

std::string validated_text(const Validated& v) {
  std::string text =
      fmt::format("never fitted: {}: rrse {:.3f} -> {:.3f}", v.record, v.rrse_before, v.rrse_after);
  if (v.has_reference)
    text += fmt::format("; where there is a reference {:.3f}, the reference {:.3f}",
                        v.same_rows_rrse, v.reference_rrse);
  if (v.start_m)
    text += fmt::format(" (slip at the start {:.1f} mm, from the first second of force)",
                        1e3 * *v.start_m);
  return text + "\n";
}

/// The final model is another one than the base: by effects, by a rig's spring or mass alone, or
/// refined by its motion.
bool adds(const Explanation& e) {
  return !e.steps.empty() || e.final.terms != e.base.terms || e.free_run.by_motion;
}

/// Each step begins where the one before it ends, the first at the base, and the last ends at the
/// final model.
void chain_errors(Explanation& e) {
  double left = e.base.held_out_nmse;
  Step* last = nullptr;
  for (Step& step : e.steps) {
    if (step.of != "force_n") continue;
    step.held_out_before = left;
    left = step.held_out_after;
    last = &step;
  }
  if (last != nullptr) last->held_out_after = e.final.held_out_nmse;
}

}  // namespace

bool is_wanted(const ModelConfig& model, std::string_view effect) {
  return std::any_of(model.candidates.begin(), model.candidates.end(),
                     [&](const std::string& name) { return name == "all" || name == effect; });
}

void put_final(Explanation& e, RunResult& result) {
  chain_errors(e);
  if (adds(e)) {
    result.base = BaseLaw{e.base.terms, e.base.parameters, result.fit};
    result.std_is_unproven = false;  // which was said of the base's
    result.fit.law_width_share.reset();
    result.fit.viscous.reset();
  }
  result.model = e.final.terms;
  result.parameters = e.final.parameters;
  result.fit.nmse.reset();
  result.fit.rrse = std::sqrt(e.final.held_out_nmse);
  result.fit.held_out_nmse = e.final.held_out_nmse;
  judge_trust(&e.known, result);
  e.trust = result.trust;
  e.trust_reasons = result.trust_reasons;
}

std::string to_json(const Explanation& e) {
  Json steps = list_of(e.steps, [&](const Step& step) { return step_json(e, step); });
  if (e.unknown && steps.empty()) steps.push_back(unknown_step(e));
  return json_text({{"schema", "dampline.explanation/1"},
                    {"verdict", e.verdict},
                    {"trust", name_of(e.trust)},
                    {"trust_reasons", e.trust_reasons},
                    {"base", model_json(e.base)},
                    {"steps", steps},
                    {"final", model_json(e.final)},
                    {"rejected", judged_json(e.rejected)},
                    {"alike", e.alike.empty() ? Json(nullptr) : Json(e.alike)},
                    {"floor_nmse", known(e.floor_nmse)},
                    {"floor_by", e.floor_by},
                    {"left_over_floor", known(e.left_over_floor)},
                    {"held_out", e.held_out},
                    {"filter_hz", known(e.filter_hz)},
                    {"free_run", free_run_json(e.free_run)},
                    {"validation", list_of(e.validation, validated_json)},
                    {"faults", list_of(e.faults, fault_json)},
                    {"notes", e.notes},
                    {"force", e.force},
                    {"signature", signature_json(e)}});
}

std::string summarize(const Explanation& e) {
  std::string text = fmt::format("{}: {}\n", e.verdict, sentence(e));
  for (const FaultFinding& f : e.faults) {
    const std::string size = fault_size(f);
    text += fmt::format("fault  {}, {}, {}{}at {:.1f} s\n", f.name, f.channel, size,
                        size.empty() ? "" : ", ", f.time_s);
  }
  if (e.held_out == "records") text += "held out: one whole record at a time\n";
  if (e.filter_hz > 0.0)
    text += fmt::format("errors of force and model behind the same filter, -3 dB at {:.4g} Hz\n",
                        e.filter_hz);
  text += model_text("base", e.base);
  for (const Step& step : e.steps) text += step_text(step);
  if (adds(e)) text += model_text("final", e.final);
  text += floor_text(e) + free_run_text(e.free_run);
  if (e.signature.rms_n > 0.0) text += "what is left: " + describe(e.signature) + "\n";
  text += fmt::format("trust  {}\n", name_of(e.trust));
  for (const std::string& reason : e.trust_reasons) text += "       " + reason + "\n";
  if (e.trust != Trust::kTrusted) text += "       The stated deviations are lower bounds.\n";
  for (const Validated& v : e.validation) text += validated_text(v);
  for (const std::string& note : e.notes) text += "note: " + note + "\n";
  return text;
}

}  // namespace dampline::app

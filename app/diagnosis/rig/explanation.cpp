// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/explanation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/diagnosis/common/evidence.hpp"
#include "app/diagnosis/common/json.hpp"
#include "app/diagnosis/rig/trials.hpp"
#include "app/text/format.hpp"

namespace dampline::app::rig {
namespace {

using Json = nlohmann::ordered_json;

Json parameters_json(const std::vector<Parameter>& parameters) {
  Json out = Json::array();
  for (const Parameter& p : parameters)
    out.push_back({{"name", p.name}, {"value", p.value}, {"std", p.std}, {"unit", p.unit}});
  return out;
}

/// Mean over the records of what each one's error is.
double mean_rrse(const Fit& fit) {
  double sum = 0.0;
  for (const double nmse : fit.record_nmse) sum += std::sqrt(nmse);
  return sum / static_cast<double>(fit.record_nmse.size());
}

Json model_json(const Model& model, const std::vector<std::string>& records) {
  Json list = Json::array();
  for (std::size_t r = 0; r < records.size(); ++r)
    list.push_back(
        {{"record", records[r]}, {"held_out_rrse", std::sqrt(model.fit.record_nmse[r])}});
  return {{"terms", model.terms},
          {"held_out_nmse", model.fit.held_out_nmse},
          {"held_out_rrse", std::sqrt(model.fit.held_out_nmse)},
          {"held_out_rrse_mean", mean_rrse(model.fit)},
          {"records", list},
          {"parameters", parameters_json(model.parameters)}};
}

/// "like X, law incomplete", where more is left than a complete law would leave.
Json note_of(const Explanation& e, const Step& step) {
  if (e.is_complete()) return nullptr;
  return fmt::format("like {}, law incomplete", step.effect);
}

Json floor_json(const Model& model, double value) {
  return model.floor_nmse > 0.0 ? Json(value) : Json(nullptr);
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
            {"block_t", step.block_t},
            {"left_over_floor", floor_json(e.final, e.final.left_over_floor())}}},
          {"note", note_of(e, step)},
          {"runners_up", judged_json(step.runners_up)}};
}

Json validated_json(const Validated& v) {
  Json out{{"record", v.record},
           {"rrse_before", v.rrse_before},
           {"rrse_after", v.rrse_after},
           {"nmse_before", v.rrse_before * v.rrse_before},
           {"nmse_after", v.rrse_after * v.rrse_after},
           {"start_slip_m", v.start_m}};
  if (!v.has_reference) return out;
  out["rrse_reference"] = v.reference_rrse;
  out["rrse_after_where_reference"] = v.same_rows_rrse;
  return out;
}

std::string lines_of(const std::vector<Parameter>& parameters) {
  std::string text;
  for (const Parameter& p : parameters) {
    const QuantityText q = format_quantity(p.value, p.std);
    text += fmt::format("    {:<36} {}{} {}\n", p.name, q.value, q.std.empty() ? "" : " ± " + q.std,
                        p.unit);
  }
  return text;
}

std::string model_text(const char* name, const Model& model) {
  std::string terms;
  for (const std::string& term : model.terms) terms += (terms.empty() ? "" : ", ") + term;
  return fmt::format("{:<6} held-out rrse {:.3f} ({:.3f} in the mean of the records): {}\n", name,
                     std::sqrt(model.fit.held_out_nmse), mean_rrse(model.fit), terms);
}

const char* sentence(const Explanation& e) {
  if (!e.alike.empty() && e.steps.empty())
    return "effects that this record cannot tell apart explain what is left alike: none is named";
  if (!e.steps.empty())
    return e.is_complete() ? "the model lacked what follows"
                           : "the model lacked what follows, and something more";
  return e.is_complete() ? "no effect of the library improves the model"
                         : "something is left that no effect of the library explains";
}

std::string floor_text(const Explanation& e) {
  if (!(e.final.floor_nmse > 0.0)) return "floor  not known\n";
  std::string text = fmt::format(
      "floor  held-out rrse {:.3g} by noise and resolution alone; left: {:.2f} times that (nmse)\n",
      std::sqrt(e.final.floor_nmse), e.final.left_over_floor());
  if (!e.is_complete() && !e.steps.empty())
    text += fmt::format("       like {}, law incomplete\n", e.steps.front().effect);
  if (!e.alike.empty()) text += fmt::format("alike  {}\n", e.alike);
  return text;
}

constexpr double kSegmentS = 8.0;  // of the spectrum, where the records are long enough
constexpr double kSegmentPoints = 512.0;
constexpr double kLawReach = 2.0;  // of the velocity's rms
constexpr int kLawPoints = 30;     // on each side
constexpr double kLeastTurn = 0.02;

/// Samples that become one point: a segment must hold some periods of the motion.
Eigen::Index joined_samples(const std::vector<Series>& records) {
  double shortest_s = 3.0 * kSegmentS;
  for (const Series& s : records)
    shortest_s = std::min(shortest_s, static_cast<double>(s.size()) * s.interval_s);
  const double segment_s = shortest_s / 3.0;
  const double joined = segment_s / (kSegmentPoints * records.front().interval_s);
  return std::max<Eigen::Index>(1, static_cast<Eigen::Index>(joined));
}

EvidenceScale scale_of_points(const std::vector<Series>& records, Eigen::Index joined) {
  EvidenceScale out;
  double count = 0.0;
  double noise_m = 0.0;
  for (const Series& s : records) {
    out.deflection_m += s.deflection_m.squaredNorm();
    out.velocity_mps += s.velocity_mps.squaredNorm();
    count += static_cast<double>(s.size());
    out.duration_s += static_cast<double>(s.size()) * s.interval_s;
    noise_m = std::max(noise_m, s.noise_m);
  }
  out.deflection_m = std::sqrt(out.deflection_m / count);
  out.velocity_mps = std::sqrt(out.velocity_mps / count);
  out.noise_m = std::max(5.0 * noise_m, kLeastTurn * out.deflection_m);
  out.rate_hz = 1.0 / (records.front().interval_s * static_cast<double>(joined));
  return out;
}

/// Takes the points of one record, whose time begins at `start_s`.
void take_record(const Explanation& e, const Series& series, double start_s, Eigen::Index joined,
                 EvidenceMeter& meter) {
  const Rows base = rows_of(e.base.columns, series, 1);
  const Rows final = rows_of(e.final.columns, seen_by(e.final, series), 1);
  const Eigen::VectorXd measured = final.values.rightCols<1>();
  const Eigen::VectorXd before = model_force(e.base, base);
  const Eigen::VectorXd after = model_force(e.final, final);
  if (final.sample.empty()) return;
  const Eigen::Index first = final.sample.front();
  for (Eigen::Index r = 0; r + joined <= measured.size(); r += joined) {
    const Eigen::Index at = first + r;
    EvidencePoint p;
    p.time_s = start_s + static_cast<double>(at) * series.interval_s;
    p.deflection_m = series.deflection_m.segment(at, joined).mean();
    p.velocity_mps = series.velocity_mps.segment(at, joined).mean();
    p.measured_n = measured.segment(r, joined).mean();
    p.base_n = before.segment(r, joined).mean();
    p.final_n = after.segment(r, joined).mean();
    p.channel = {p.deflection_m, p.velocity_mps, std::abs(p.velocity_mps)};
    meter.add(p);
  }
  meter.gap();
}

/// In steady sliding at v, undeflected: every friction element has slipped long since.
double sliding_force(const Model& model, double v) {
  Series slide;
  slide.interval_s = 1.0;
  slide.deflection_m = Eigen::Vector2d{v < 0.0 ? 1.0 : -1.0, 0.0};
  slide.velocity_mps = Eigen::Vector2d{v, v};
  slide.force_n = Eigen::Vector2d::Zero();
  double out = 0.0;
  for (std::size_t c = 0; c < model.columns.size(); ++c)
    out += model.fit.theta[static_cast<Eigen::Index>(c)] * evaluate(model.columns[c], slide)[1];
  return out;
}

}  // namespace

bool Explanation::is_complete() const noexcept {
  const double nmse = final.fit.held_out_nmse;
  const double above = kMotionAbove + (kIncompleteAbove - kMotionAbove) * final.floor_noise_share;
  return alike.empty() && (nmse <= above * final.floor_nmse || nmse < kNegligible);
}

const char* Explanation::verdict() const {
  if (steps.empty()) return is_complete() ? "complete" : "unexplained";
  return is_complete() ? "explained" : "partly_explained";
}

std::string to_json(const Explanation& e) {
  Json steps = Json::array();
  for (const Step& step : e.steps) steps.push_back(step_json(e, step));
  const bool unknown = !e.is_complete();
  if (unknown && e.steps.empty())
    steps.push_back(unknown_step(e.base.terms, e.base.fit.held_out_nmse, e.signature));
  Json validation = Json::array();
  for (const Validated& v : e.validation) validation.push_back(validated_json(v));
  const Json json{
      {"verdict", e.verdict()},
      {"base", model_json(e.base, e.records)},
      {"steps", steps},
      {"final", model_json(e.final, e.records)},
      {"rejected", judged_json(e.rejected)},
      {"alike", e.alike.empty() ? Json(nullptr) : Json(e.alike)},
      {"floor_nmse", floor_json(e.final, e.final.floor_nmse)},
      {"left_over_floor", floor_json(e.final, e.final.left_over_floor())},
      {"held_out", e.whole_records ? "records" : "blocks"},
      {"filter_hz", e.filter_hz > 0.0 ? Json(e.filter_hz) : Json(nullptr)},
      {"validation", validation},
      {"faults", Json::array()},
      {"notes", e.notes},
      {"force", e.filter_hz > 0.0 ? "measured, behind the filter of the fit" : "measured"},
      {"signature", signature_json(e.signature, {"deflection", "velocity", "speed"}, unknown)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string summarize(const Explanation& e) {
  std::string text = fmt::format(
      "{}: {}\n  held out: {}\n", e.verdict(), sentence(e),
      e.whole_records ? "one whole record at a time" : "interleaved blocks, five folds");
  if (e.filter_hz > 0.0)
    text += fmt::format("  errors of force and model behind the same filter, -3 dB at {:.4g} Hz\n",
                        e.filter_hz);
  text += model_text("base", e.base) + lines_of(e.base.parameters);
  for (const Step& step : e.steps) {
    text +=
        fmt::format("+ {}: {}rrse {:.3f} -> {:.3f}, t {:.1f}\n", step.effect,
                    step.of == "force_n" ? "held-out " : step.of + ": ",
                    std::sqrt(step.held_out_before), std::sqrt(step.held_out_after), step.block_t);
    text += lines_of(step.parameters);
    for (const JudgedCandidate& c : step.runners_up)
      text +=
          fmt::format("    {:<36} {} {:.3f}\n", "runner-up", c.effect, std::sqrt(c.held_out_nmse));
  }
  text += model_text("final", e.final) + floor_text(e);
  text += "what is left: " + describe(e.signature) + "\n";
  for (const Validated& v : e.validation) {
    text += fmt::format("never fitted: {}: rrse {:.3f} -> {:.3f}", v.record, v.rrse_before,
                        v.rrse_after);
    if (v.has_reference)
      text += fmt::format("; where there is a reference {:.3f}, the reference {:.3f}",
                          v.same_rows_rrse, v.reference_rrse);
    text += fmt::format(" (slip at the start {:.1f} mm, from the first second of force)\n",
                        1e3 * v.start_m);
  }
  for (const std::string& note : e.notes) text += "note: " + note + "\n";
  return text;
}

Eigen::VectorXd model_force(const Model& model, const Rows& rows) {
  return rows.values.leftCols(model.fit.theta.size()) * model.fit.theta;
}

Series seen_by(const Model& model, const Series& series) {
  Series out = model.skew_s != 0.0 ? delayed(series, model.skew_s) : series;
  out.path = model.path;
  return out;
}

void gather_evidence(const std::vector<Series>& records, Explanation& e) {
  const Eigen::Index joined = joined_samples(records);
  const EvidenceScale scale = scale_of_points(records, joined);
  EvidenceMeter meter{scale};
  double start_s = 0.0;
  for (const Series& series : records) {
    take_record(e, series, start_s, joined, meter);
    start_s += static_cast<double>(series.size()) * series.interval_s;
  }
  meter.fill(e.evidence);
  e.signature = meter.signature();
  for (int i = -kLawPoints; i <= kLawPoints; ++i) {
    if (i == 0) continue;
    const double v = kLawReach * scale.velocity_mps * i / kLawPoints;
    e.evidence.law.push_back({v, sliding_force(e.base, v), sliding_force(e.final, v)});
  }
  std::uint32_t record = 0;
  for (const Validated& v : e.validation) {
    ++record;
    for (PredictedRow row : v.rows) {
      row.record = record;
      e.evidence.prediction.push_back(row);
    }
  }
}

}  // namespace dampline::app::rig

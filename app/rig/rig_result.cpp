// SPDX-License-Identifier: MIT
#include "app/rig/rig_result.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/rig/rig_history.hpp"
#include "app/rig/rig_terms.hpp"
#include "app/text/quantity.hpp"

namespace dampline::app {
namespace {

constexpr double kPoorRrse = 0.3;
constexpr double kSpringMatters = 0.8;  // of the held-out error without one

std::string words(const Parameter& parameter) {
  const QuantityText text = format_quantity(parameter.value, parameter.std);
  const std::string band = text.std.empty() ? "" : " ± " + text.std;
  return fmt::format("{} {}{} {}", parameter.name, text.value, band, parameter.unit);
}

void fill_parameters(const RigSnapshot& snapshot, RunResult& result) {
  for (std::size_t i = 0; i < snapshot.size; ++i) {
    const RigEstimate& e = snapshot.estimates[i];
    result.parameters.push_back({rig_parameter_name(e.parameter), e.estimate.value, e.estimate.std,
                                 rig_parameter_unit(e.parameter)});
  }
}

void fill_counts(const RigCounts& c, RunResult& result) {
  result.counts = {{"samples", c.samples},
                   {"gaps", c.gaps},
                   {"lost", c.lost},
                   {"repeated", c.repeated},
                   {"not_finite", c.not_finite},
                   {"blocks_used", c.blocks},
                   {"rows", c.rows},
                   {"rows_still", c.rows_still}};
}

void fill_curve(const RigCurve& curve, RunResult& result) {
  for (std::size_t i = 0; i < curve.size; ++i) {
    const CurvePoint& p = curve.points[i];
    result.curve.push_back({p.velocity_mps, p.force_n, p.std_n, p.samples});
  }
}

std::string asymmetry_text(const RigSnapshot& snapshot) {
  const RigCurve& curve = snapshot.curve;
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

std::string filter_note(const RigFindings& f) {
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

std::string velocity_note(const RigConfig& config) {
  if (config.velocity_measured) return "Velocity: measured (velocity_mps).";
  return fmt::format("Velocity: derived from the deflection over {} samples.",
                     2 * config.velocity_half_width + 1);
}

bool is_poor(const RigErrors& errors) { return std::sqrt(errors.nmse) > kPoorRrse; }

std::string fit_text(const RigErrors& errors) {
  const double rrse = std::sqrt(errors.nmse);
  const double held_out = std::sqrt(errors.held_out_nmse);
  if (!is_poor(errors))
    return fmt::format("The model explains this rig up to rrse {:.3f}, held out {:.3f}.", rrse,
                       held_out);
  return fmt::format(
      "This is a poor model of this rig: rrse {:.3f}, held out {:.3f}. An effect is missing, and "
      "the "
      "parameters are only the best that this model can do.",
      rrse, held_out);
}

std::string spring_note(const RigFindings& f) {
  if (!f.with_spring || !f.with_spring->valid) return "";
  if (f.with_spring->held_out_nmse > kSpringMatters * f.snapshot.held_out_nmse) return "";
  double stiffness = 0.0;
  for (std::size_t i = 0; i < f.with_spring->size; ++i)
    if (f.with_spring->estimates[i].parameter == RigParameter::kStiffness)
      stiffness = f.with_spring->estimates[i].estimate.value;
  return fmt::format(
      "A linear spring of {:.3g} N/m would lower the held-out rrse from {:.3f} to {:.3f}. If the "
      "measured force contains a spring, set stiffness = \"identify\" in [model]; otherwise "
      "friction "
      "with memory (presliding, backlash) looks like this.",
      stiffness, std::sqrt(f.snapshot.held_out_nmse), std::sqrt(f.with_spring->held_out_nmse));
}

void fill_notes(const RigFindings& f, RunResult& result) {
  (is_poor(f.errors) ? result.warnings : result.notes).push_back(fit_text(f.errors));
  for (std::string note : {spring_note(f), filter_note(f), velocity_note(f.config)})
    if (!note.empty()) result.notes.push_back(std::move(note));
}

std::string headline(const RigFindings& f, const RunResult& result) {
  std::string text;
  for (const Parameter& parameter : result.parameters)
    text += (text.empty() ? "" : ", ") + words(parameter);
  return fmt::format("{}: {} Rrse {:.3f}, from {} of record.", text,
                     is_poor(f.errors) ? "a poor model of this rig." : "the model fits.",
                     std::sqrt(f.errors.nmse), format_duration(result.duration_s));
}

}  // namespace

RunResult describe_rig(const RigFindings& f) {
  RunResult result;
  result.kind = "rig";
  result.model = term_names(f.terms);
  fill_parameters(f.snapshot, result);
  fill_counts(f.snapshot.counts, result);
  fill_curve(f.snapshot.curve, result);
  result.fit = {f.errors.nmse, std::sqrt(f.errors.nmse), f.errors.held_out_nmse};
  result.asymmetry = asymmetry_text(f.snapshot);
  const auto samples = static_cast<double>(f.snapshot.counts.samples);
  result.excitation = 1.0 - static_cast<double>(f.still_samples) / samples;
  result.sample_rate_hz = Estimate{f.config.sample_rate_hz, 0.0};
  result.latency_s = f.latency_samples / f.config.sample_rate_hz;
  result.duration_s = static_cast<double>(f.ticks) / f.config.sample_rate_hz;
  result.headline = headline(f, result);
  fill_notes(f, result);
  return result;
}

}  // namespace dampline::app

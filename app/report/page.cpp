// SPDX-License-Identifier: MIT
#include "app/report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "app/report/advice.hpp"
#include "app/report/answer.hpp"
#include "app/report/assets.hpp"
#include "app/report/html.hpp"
#include "app/report/plots.hpp"
#include "app/report/sections.hpp"
#include "app/text/format.hpp"

namespace dampline::app {

namespace {

constexpr std::string_view kCurveText =
    "The force with which the suspension resists motion, over the relative velocity. In the grey "
    "zone the velocity is too uncertain to resolve "
    "the curve. The strip at the bottom shows how many samples stand behind each part: where it is "
    "low, the curve is little more than the straight continuation of its neighbours.";
constexpr std::string_view kRigCurveText =
    "The part of the measured force that resists motion, over the velocity. The strip at the "
    "bottom shows how many samples stand behind each part.";
constexpr std::string_view kBandHolds = " The band holds the truth in about 19 of 20 cases.";
constexpr std::string_view kBandDoesNot =
    " The band is that of this model; it does not hold the truth, since the model or the data are "
    "not to be trusted.";
constexpr std::string_view kZoomText =
    "<p class=\"note only-live\">Drag over a plot to enlarge a part of it, on a phone with two "
    "fingers; a double click or tap shows all of it again. A plot in focus takes the arrow keys, + "
    "and -.</p>\n";
constexpr std::string_view kFaultText =
    "Faults of sensors and of the transport. A line leads from where a fault was first seen to "
    "where "
    "it was last seen; orange seconds hold samples that it spoils, grey blocks were left out.";
constexpr std::string_view kMethodText =
    "The force against the direction of motion, as each method finds it; shaded, where it is to be "
    "trusted: two standard deviations. What stands on an assumption that this record contradicts "
    "is drawn grey and dashed.";
constexpr std::string_view kDensityText =
    "How often each deflection and each velocity occurred, as densities. The thin line is the "
    "normal distribution of the same mean and variance.";
constexpr std::string_view kConvergenceText =
    "The same parameters as they were known at each moment of the record. A line that has come to "
    "rest inside a shrinking band is settled; one that still wanders is not.";
constexpr std::string_view kMotionText =
    "An excerpt of the motion between frame and wheelsets, y = 2 z_b - (z_1 + z_2), drift removed. "
    "Slow deflection (below about 1 Hz) cannot be known from accelerations and is not shown.";
constexpr std::string_view kExcludedText =
    "Stretches of the record that took no part in the estimate, a row for each reason.";
constexpr std::string_view kEventText =
    "What happened beside the samples: markers and pulses of the digital lines, and what befell "
    "the "
    "bus and the recording. The numbers are in events.csv.";
constexpr std::string_view kLatenessText =
    "How long after a frame's stamp its result was there. Both axes are logarithmic; a bin is a "
    "sixteenth of a factor of two. The numbers are in lateness.csv.";
constexpr std::string_view kRigMotionText = "An excerpt of the measured motion.";
constexpr std::string_view kForceText =
    "An excerpt of the measured force beside the force of the fitted model, over time and over "
    "velocity. Where the two clouds part, the model lacks something.";

constexpr std::string_view kWindowText =
    "Each dot is what one window of rows alone says, with two of the deviations that it states "
    "itself. Scatter beyond them is what such windows cannot tell: a parameter that changes, a "
    "term that is missing, noise that neighbouring rows share.";
constexpr std::string_view kCovText =
    "Coefficient of variation over time, on a logarithmic axis: of windows, the scatter of all "
    "estimates so far over their mean; of the whole record, deviation over estimate. The numbers "
    "are in cov.csv.";
constexpr std::string_view kTermSetText =
    "The error that each set of terms leaves. One that falls when a term goes, held out, says that "
    "the term was too many; one that falls when a term is added, that it was missing. The numbers "
    "are in term_sets.csv.";

constexpr std::string_view kResidualText =
    "What the model leaves of the force, before and after the effects were added. A mean that is "
    "not zero over deflection or velocity is a law that is missing; what has no place there but a "
    "frequency is a motion or a sensor.";
constexpr std::string_view kLoopText =
    "An excerpt: the force over velocity and over deflection, measured, and by the model before "
    "and after.";
constexpr std::string_view kLawText =
    "The part of the force that resists motion, in steady sliding and undeflected, by the model "
    "before and after.";
constexpr std::string_view kPredictionText =
    "A record that was never fitted: measured, and predicted from its motion alone. The stretch "
    "of twenty seconds with the largest force.";

std::string section(std::string_view title, const std::string& body) {
  return body.empty() ? "" : fmt::format("<h2>{}</h2>\n{}", title, body);
}

constexpr std::uint32_t kDrawnRecords = 6;

/// What an explanation shows.
std::string evidence_sections(const Evidence& evidence) {
  if (evidence.explanation.empty()) return "";
  std::string out = section("What the model lacked", verdict_section(evidence));
  out +=
      section("Left before and after", figure(plot_residual(evidence), "residual", kResidualText));
  out += section("Loops", figure(plot_loops(evidence), "loops", kLoopText));
  out += section("Curve before and after", figure(plot_law(evidence), "law", kLawText));
  out += section("Candidates", candidate_section(evidence));
  std::string drawn = validation_section(evidence);
  const std::uint32_t records = std::min(predicted_records(evidence), kDrawnRecords);
  for (std::uint32_t r = 1; r <= records; ++r)
    drawn += figure(plot_prediction(evidence, r), fmt::format("prediction{}", r), kPredictionText);
  return out + section("Records that were never fitted", drawn);
}

/// What stands above everything else: of what this is, the answer, and whether it is to be trusted.
std::string opening(const RunResult& result, const Provenance& provenance,
                    const std::string& run_toml) {
  std::string out = identity_section(result, provenance, run_toml) +
                    answer_section(result, run_toml) + warning_section(result);
  if (!result.evidence.explanation.empty())
    out += fmt::format("<p>{}</p>\n", escape_html(explanation_headline(result.evidence)));
  return out;
}

std::string curve_section(const RunResult& result) {
  const std::string_view text = result.kind == "truck" ? kCurveText : kRigCurveText;
  const bool holds = result.trust == Trust::kTrusted;
  const std::string drawn = figure(plot_curve(result), "curve",
                                   std::string{text}.append(holds ? kBandHolds : kBandDoesNot));
  return drawn.empty() ? "" : drawn + std::string{kZoomText};
}

}  // namespace

std::string make_page(const RunResult& result, const Provenance& provenance,
                      const std::string& run_toml) {
  const bool truck = result.kind == "truck";
  std::string body = opening(result, provenance, run_toml);
  body += section("Damping curve", curve_section(result));
  body += section(truck ? "What to check on the truck" : "What to check on the rig",
                  advice_section(result));
  body += evidence_sections(result.evidence);
  body += section("Parameters", parameter_section(result)) +
          section("The model before", base_section(result));
  body += section("The law as an equation", law_section(result));
  body += section("Terms", term_section(result));
  body += section("Other sets of terms", figure(plot_term_sets(result), "term-sets", kTermSetText) +
                                             term_set_section(result));
  body += section("Quality", quality_section(result));
  body += section("Data quality",
                  figure(plot_faults(result), "faults", kFaultText) + fault_section(result));
  body += section("Other methods",
                  figure(plot_methods(result), "methods", kMethodText) + method_section(result));
  body += section("Densities", figure(plot_densities(result), "densities", kDensityText));
  body += section("Phase space", phase_section(result));
  body += section("How the estimate settled",
                  figure(plot_convergence(result), "convergence", kConvergenceText));
  body += section("Windows", figure(plot_windows(result), "windows", kWindowText));
  body += section("Coefficients of variation", figure(plot_cov(result), "cov", kCovText));
  body += section("Measured and fitted force", figure(plot_force(result), "force", kForceText));
  body += section("Motion",
                  figure(plot_motion(result), "motion", truck ? kMotionText : kRigMotionText));
  body += section("Events", figure(plot_events(result), "events", kEventText));
  body += section("How the acquisition kept up",
                  figure(plot_lateness(result), "lateness", kLatenessText) + live_section(result));
  body +=
      section("What was left out, and why",
              figure(plot_excluded(result), "excluded", kExcludedText) + excluded_section(result));
  body += section("Where this comes from", provenance_section(provenance, run_toml));
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>dampline: {}</title>\n{}</head><body>\n<main>\n{}</main>\n{}</body></html>\n",
      escape_html(record_name(provenance)), page_head(), body, page_scripts());
}

void stage_report(const RunFiles& files, RunDirectory& directory) {
  directory.write(
      "report.html",
      make_page(files.result, read_provenance(files.run_toml, "run.toml"), files.run_toml));
}

}  // namespace dampline::app

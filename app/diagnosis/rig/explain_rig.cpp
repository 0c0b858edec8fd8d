// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/explain_rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "app/diagnosis/rig/driven_mass.hpp"
#include "app/diagnosis/rig/rig_evidence_points.hpp"
#include "app/diagnosis/rig/rig_gain.hpp"
#include "app/diagnosis/rig/rig_search.hpp"
#include "app/error.hpp"

namespace dampline::app {
namespace {

constexpr double kStartS = 1.0;  // of measured force that may set the slip at the start
constexpr int kStarts = 40;

/// Longest travel of a model's friction elements.
double longest_travel_m(const RigModel& model) {
  double out = 0.0;
  for (const RigColumn& c : model.columns)
    if (c.kind >= RigColumn::Kind::kStop) out = std::max(out, c.a);
  return out;
}

/// The slip at the start that fits the first second best.
double start_of(const RigModel& model, const RigSeries& series) {
  const double longest_m = longest_travel_m(model);
  RigSeries first = series;
  const auto count =
      std::min(series.size(), static_cast<Eigen::Index>(kStartS / series.interval_s));
  first.deflection_m.conservativeResize(count);
  first.velocity_mps.conservativeResize(count);
  first.force_n.conservativeResize(count);
  double best = 0.0;
  double best_m = 0.0;
  for (int i = -kStarts; i <= kStarts; ++i) {
    first.start_m = longest_m * i / kStarts;
    const RigRows rows = rows_of(model.columns, first, 1);
    if (rows.values.rows() == 0) return 0.0;
    const double error = (rows.values.rightCols<1>() - model_force(model, rows)).squaredNorm();
    if (i > -kStarts && error >= best) continue;
    best = error;
    best_m = first.start_m;
  }
  return best_m;
}

double rrse(const Eigen::VectorXd& measured, const Eigen::VectorXd& predicted) {
  return std::sqrt((measured - predicted).squaredNorm() /
                   (measured.array() - measured.mean()).square().sum());
}

void compare_reference(const RigSeries& series, const RigRows& rows, const Eigen::VectorXd& final,
                       RigValidated& out) {
  if (series.reference_n.size() != series.size()) return;
  std::vector<double> measured;
  std::vector<double> reference;
  std::vector<double> ours;
  for (std::size_t r = 0; r < rows.sample.size(); ++r) {
    const double value = series.reference_n[rows.sample[r]];
    if (!std::isfinite(value)) continue;
    const auto at = static_cast<Eigen::Index>(r);
    measured.push_back(rows.values(at, rows.values.cols() - 1));
    reference.push_back(value);
    ours.push_back(final[at]);
  }
  if (measured.size() < 2) return;
  const auto vector = [](const std::vector<double>& v) {
    return Eigen::VectorXd{
        Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()))};
  };
  out.has_reference = true;
  out.reference_rrse = rrse(vector(measured), vector(reference));
  out.same_rows_rrse = rrse(vector(measured), vector(ours));
}

RigValidated validate(const RigExplanation& explanation, RigSeries series) {
  RigValidated out;
  out.record = series.record;
  const RigRows base = rows_of(explanation.base.columns, series, 1);
  series = seen_by(explanation.final, series);
  out.start_m = start_of(explanation.final, series);
  series.start_m = out.start_m;
  const RigRows final = rows_of(explanation.final.columns, series, 1);
  if (final.values.rows() < 2)
    throw RunError{fmt::format("{}: too short to validate on", out.record)};
  const Eigen::VectorXd measured = final.values.rightCols<1>();
  const Eigen::VectorXd predicted = model_force(explanation.final, final);
  const Eigen::VectorXd before = model_force(explanation.base, base);
  out.rrse_before = rrse(measured, before);
  out.rrse_after = rrse(measured, predicted);
  compare_reference(series, final, predicted, out);
  for (std::size_t r = 0; r < final.sample.size(); ++r) {
    out.time_s.push_back(series.time_s[final.sample[r]]);
    out.measured_n.push_back(measured[static_cast<Eigen::Index>(r)]);
    out.predicted_n.push_back(predicted[static_cast<Eigen::Index>(r)]);
    out.base_n.push_back(before[static_cast<Eigen::Index>(r)]);
    out.reference_n.push_back(series.reference_n.size() == series.size()
                                  ? series.reference_n[final.sample[r]]
                                  : std::numeric_limits<double>::quiet_NaN());
  }
  return out;
}

std::vector<RigSeries> read_records(const Config& config, const RigExplainOptions& options) {
  std::vector<RigSeries> out;
  for (const std::string& path : options.records) {
    out.push_back(read_rig_series(path, config, options.skip_bad_lines));
    if (out.back().has_gap && config.model.inertia == "identify")
      throw RunError{fmt::format(
          "{}: has gaps or values that are no number; expected none where the mass is identified",
          path)};
    if (out.back().size() < 500)
      throw RunError{fmt::format("{}: found {} usable samples, expected at least 500", path,
                                 out.back().size())};
  }
  return out;
}

bool has_gaps(const std::vector<RigSeries>& records) {
  return std::any_of(records.begin(), records.end(), [](const RigSeries& s) { return s.has_gap; });
}

struct Explained {
  Config config;
  std::vector<RigSeries> records;
  std::vector<RigGains> gains;
  RigExplanation explanation;
};

Explained search(const Config& config, const RigExplainOptions& options) {
  Explained out{config, read_records(config, options), {}, {}};
  for (const RigSeries& record : out.records) out.gains.push_back(checked_gains(record));
  out.explanation = RigSearch{config, out.records}.run();
  return out;
}

/// A mass behind a filter, which takes noise away, has to be plainer or better by far.
bool is_preferred(const RigExplanation& second, const RigExplanation& first) {
  constexpr double kByFar = 0.1;
  if (!second.base.fit.ok) return false;
  const double share = second.final.fit.held_out_nmse / first.final.fit.held_out_nmse;
  if (!second.is_complete()) return !first.is_complete() && share < 1.0;
  return !first.is_complete() || second.steps.size() < first.steps.size() || share < kByFar;
}

/// Where an inertia carries much of the force, the mass is identified too.
void try_driven_mass(Explained& found, const RigExplainOptions& options) {
  RigExplanation& first = found.explanation;
  if (found.config.model.inertia != "auto" || !is_driven_mass(found.records)) return;
  if (has_gaps(found.records)) {
    first.notes.insert(first.notes.begin(),
                       "An inertia carries much of the force, but the record has gaps: no mass was "
                       "identified, and what follows describes the force without it.");
    return;
  }
  Config config = found.config;
  config.model.inertia = "identify";
  Explained driven = search(config, options);
  RigExplanation& second = driven.explanation;
  if (!is_preferred(second, first)) return;
  second.notes.insert(second.notes.begin(),
                      "An inertia carries much of the force: the mass is identified too. To leave "
                      "it out: [model] inertia = \"none\"");
  found = std::move(driven);
}

}  // namespace

RigExplanation explain_rig(const Config& given, const RigExplainOptions& options) {
  Explained found = search(given, options);
  try_driven_mass(found, options);
  const std::vector<RigSeries>& records = found.records;
  RigExplanation& out = found.explanation;
  for (const RigSeries& record : records)
    for (const std::string& note : record.notes)
      out.notes.push_back(records.size() > 1 ? fmt::format("{}: {}", record.record, note) : note);
  if (!out.base.fit.ok)
    throw RunError{fmt::format("{}: too little motion to determine the model", records[0].record)};
  judge_gains(found.gains, out);
  for (const std::string& path : options.validation)
    out.validation.push_back(validate(
        out,
        read_rig_series(path, found.config, options.skip_bad_lines, options.reference_column)));
  gather_evidence(records, out);
  return std::move(found.explanation);
}

}  // namespace dampline::app

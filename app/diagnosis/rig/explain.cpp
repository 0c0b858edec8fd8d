// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/explain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "app/diagnosis/rig/explanation.hpp"
#include "app/diagnosis/rig/gain.hpp"
#include "app/diagnosis/rig/law.hpp"
#include "app/diagnosis/rig/library.hpp"
#include "app/diagnosis/rig/regression.hpp"
#include "app/diagnosis/rig/steps.hpp"
#include "app/diagnosis/rig/thresholds.hpp"
#include "app/error.hpp"

namespace dampline::app::rig {
namespace {

constexpr double kSignWidths = 3.0;  // times the width that an error of the velocity makes
constexpr double kWidthRatio = 1.5;  // from one way to write friction to the next

constexpr double kStartS = 1.0;  // of measured force that may set the slip at the start
constexpr int kStarts = 40;

/// Longest travel of a model's friction elements.
double longest_travel_m(const Model& model) {
  double out = 0.0;
  for (const Regressor& c : model.columns)
    if (c.kind >= Kind::kStop) out = std::max(out, c.a);
  return out;
}

/// The slip at the start that fits the first second best.
double start_of(const Model& model, const Series& series) {
  const double longest_m = longest_travel_m(model);
  Series first = series;
  const auto count =
      std::min(series.size(), static_cast<Eigen::Index>(kStartS / series.interval_s));
  first.deflection_m.conservativeResize(count);
  first.velocity_mps.conservativeResize(count);
  first.force_n.conservativeResize(count);
  double best = 0.0;
  double best_m = 0.0;
  for (int i = -kStarts; i <= kStarts; ++i) {
    first.start_m = longest_m * i / kStarts;
    const Rows rows = rows_of(model.columns, first, 1);
    if (rows.values.rows() == 0) return 0.0;
    const double error = (rows.values.rightCols<1>() - model_force(model, rows)).squaredNorm();
    if (i > -kStarts && error >= best) continue;
    best = error;
    best_m = first.start_m;
  }
  return best_m;
}

Eigen::VectorXd column_of(const std::vector<PredictedRow>& rows, double PredictedRow::*value) {
  Eigen::VectorXd out{static_cast<Eigen::Index>(rows.size())};
  for (std::size_t r = 0; r < rows.size(); ++r) out[static_cast<Eigen::Index>(r)] = rows[r].*value;
  return out;
}

double rrse(const std::vector<PredictedRow>& rows, double PredictedRow::*predicted) {
  const Eigen::VectorXd measured = column_of(rows, &PredictedRow::measured_n);
  return std::sqrt((measured - column_of(rows, predicted)).squaredNorm() /
                   (measured.array() - measured.mean()).square().sum());
}

Validated validate(const Explanation& explanation, Series series) {
  Validated out;
  out.record = series.record;
  const Eigen::VectorXd before =
      model_force(explanation.base, rows_of(explanation.base.columns, series, 1));
  series = seen_by(explanation.final, series);
  series.start_m = start_of(explanation.final, series);
  out.start_m = series.start_m;
  const Rows final = rows_of(explanation.final.columns, series, 1);
  if (final.values.rows() < 2)
    throw RunError{fmt::format("{}: too short to validate on", out.record)};
  const Eigen::VectorXd predicted = model_force(explanation.final, final);
  const bool has_reference = series.reference_n.size() == series.size();
  for (std::size_t r = 0; r < final.sample.size(); ++r) {
    const auto at = static_cast<Eigen::Index>(r);
    PredictedRow row;
    row.time_s = series.time_s[final.sample[r]];
    row.measured_n = final.values(at, final.values.cols() - 1);
    row.predicted_n = predicted[at];
    row.base_n = before[at];
    if (has_reference) row.reference_n = series.reference_n[final.sample[r]];
    out.rows.push_back(row);
  }
  out.rrse_before = rrse(out.rows, &PredictedRow::base_n);
  out.rrse_after = rrse(out.rows, &PredictedRow::predicted_n);
  std::vector<PredictedRow> both = out.rows;
  std::erase_if(both, [](const PredictedRow& row) { return !std::isfinite(row.reference_n); });
  out.has_reference = both.size() >= 2;
  if (!out.has_reference) return out;
  out.reference_rrse = rrse(both, &PredictedRow::reference_n);
  out.same_rows_rrse = rrse(both, &PredictedRow::predicted_n);
  return out;
}

/// Wrong values that left gaps, named.
std::string gaps_of(const Series& series) {
  std::string out;
  for (const FaultFinding& f : series.faults)
    out +=
        fmt::format("; found {} wrong values in {} from {:.3f} s on", f.count, f.channel, f.time_s);
  return out;
}

std::vector<Series> read_records(const Config& config, const ExplainOptions& options) {
  std::vector<Series> out;
  for (const std::string& path : options.records) {
    out.push_back(read_series(path, config, options.skip_bad_lines));
    if (out.back().has_gap && config.model.inertia == "identify")
      throw RunError{fmt::format(
          "{}: has gaps or values that are no number; expected none where the mass is identified{}",
          path, gaps_of(out.back()))};
    if (out.back().size() < 500)
      throw RunError{fmt::format("{}: found {} usable samples, expected at least 500", path,
                                 out.back().size())};
  }
  return out;
}

bool has_gaps(const std::vector<Series>& records) {
  return std::any_of(records.begin(), records.end(), [](const Series& s) { return s.has_gap; });
}

struct Explained {
  Config config;
  std::vector<Series> records;
  std::vector<Gains> gains;
  Explanation explanation;
};

/// Friction or damping, or both: what the records bear out beside a spring that may bend.
std::vector<std::string> base_of(const std::vector<Series>& records, bool inertia) {
  const Scale scale = scale_of(records);
  std::vector<Regressor> columns{{Kind::kOne, 0.0, 0.0},
                                 {Kind::kDeflection, 0.0, 0.0},
                                 {Kind::kCube, 0.0, 0.0},
                                 {Kind::kVelocity, 0.0, 0.0}};
  ColumnSet beside{0, 1, 2};
  if (inertia) {
    beside.push_back(static_cast<Eigen::Index>(columns.size()));
    columns.push_back({Kind::kInertia, 0.0, 0.0});
  }
  const auto first = static_cast<Eigen::Index>(columns.size());
  const double narrow_mps = kSignWidths * scale.sign_mps;
  columns.push_back({Kind::kSign, narrow_mps, 0.0});
  for (const double a : ratios(narrow_mps, kWidestFriction * scale.velocity_mps, kWidthRatio))
    columns.push_back({Kind::kSign, a, 0.0});
  const Regression evidence{columns, records};
  const auto best = [&](const ColumnSet& damping) {
    Fit out;
    for (Eigen::Index w = first; w < static_cast<Eigen::Index>(columns.size()); ++w) {
      const ColumnSet more = joined({w}, damping);
      Fit fit = evidence.fit(joined(more, beside), 0.0);
      if (fit.beats(out) && fit.theta.head(static_cast<Eigen::Index>(more.size())).minCoeff() > 0.0)
        out = std::move(fit);
    }
    return out;
  };
  const Fit damped = evidence.fit(joined({3}, beside), 0.0);
  const Fit rubbed = best({});
  const Fit both = best({3});
  const bool damps = damped.ok && damped.theta[0] > 0.0;
  const Fit& alone = damps && !rubbed.beats(damped) ? damped : rubbed;
  if (both.ok && alone.ok && both.held_out_nmse < kBothNeeded * alone.held_out_nmse &&
      block_t(alone, both) > kLaterSignificant)
    return {"coulomb", "viscous"};
  return {&alone == &damped ? "viscous" : "coulomb"};
}

Explained read(const Config& config, const ExplainOptions& options) {
  Explained out{config, read_records(config, options), {}, {}};
  for (const Series& record : out.records) out.gains.push_back(checked_gains(record));
  return out;
}

void look_for_law(Explained& out, const ExplainOptions& options) {
  Config config = out.config;
  if (!is_base_declared(config.model))
    config.model.base = base_of(out.records, config.model.inertia == "identify");
  const bool chosen = config.model.base != out.config.model.base;
  out.explanation = search(config, out.records, is_base_declared(out.config.model), options.refine);
  if (chosen)
    out.explanation.notes.emplace_back(
        "Nobody declared a base: the record bears out what stands there. To fix it: [model] base");
}

/// A mass behind a filter, which takes noise away, has to be plainer or better by far.
bool is_preferred(const Explanation& second, const Explanation& first) {
  if (!second.base.fit.ok) return false;
  const double share = second.final.fit.held_out_nmse / first.final.fit.held_out_nmse;
  if (!second.is_complete()) return !first.is_complete() && share < 1.0;
  return !first.is_complete() || second.steps.size() < first.steps.size() || share < kByFar;
}

/// Whether an inertia takes most of what a spring and friction leave of the force: the force moves
/// a mass, and is not that of a damper whose motion is prescribed.
bool is_driven_mass(const std::vector<Series>& records) {
  double width_mps = 0.0;
  for (const Series& s : records) width_mps = std::max(width_mps, s.config.sign_width_mps);
  const Regression evidence{{{Kind::kOne, 0.0, 0.0},
                             {Kind::kDeflection, 0.0, 0.0},
                             {Kind::kCube, 0.0, 0.0},
                             {Kind::kVelocity, 0.0, 0.0},
                             {Kind::kSign, kSignWidths * width_mps, 0.0},
                             {Kind::kAcceleration, 0.0, 0.0}},
                            records};
  const Fit without = evidence.fit({0, 1, 2, 3, 4}, 0.0);
  const Fit with = evidence.fit({0, 1, 2, 3, 4, 5}, 0.0);
  return without.ok && with.ok && with.theta[5] > 0.0 &&
         with.held_out_nmse < kDominantMass * without.held_out_nmse;
}

Explained with_mass(Config config, const ExplainOptions& options) {
  config.model.inertia = "identify";
  Explained out = read(config, options);
  look_for_law(out, options);
  auto& notes = out.explanation.notes;
  notes.insert(notes.begin(),
               "An inertia carries much of the force: the mass is identified too. To leave it out: "
               "[model] inertia = \"none\"");
  return out;
}

/// Nothing says more than a motion that the force alone makes: the law without a mass need not be
/// looked for.
bool is_certain(const Explanation& driven) {
  return driven.base.fit.ok && driven.is_complete() && driven.final.free_run.followed;
}

/// Where an inertia carries much of the force, with its mass.
Explained look_for(const Config& config, const ExplainOptions& options) {
  Explained out = read(config, options);
  const bool driven = config.model.inertia == "auto" && is_driven_mass(out.records);
  const bool gaps = driven && has_gaps(out.records);
  std::optional<Explained> second;
  if (driven && !gaps) second = with_mass(config, options);
  if (second && is_certain(second->explanation)) return *std::move(second);
  look_for_law(out, options);
  if (second && is_preferred(second->explanation, out.explanation)) return *std::move(second);
  if (gaps)
    out.explanation.notes.insert(
        out.explanation.notes.begin(),
        "An inertia carries much of the force, but the record has gaps: no mass was identified, "
        "and what follows describes the force without it.");
  return out;
}

}  // namespace

Explanation explain(const Config& given, const ExplainOptions& options) {
  Explained found = look_for(given, options);
  const std::vector<Series>& records = found.records;
  Explanation& out = found.explanation;
  for (const Series& record : records)
    out.faults.insert(out.faults.end(), record.faults.begin(), record.faults.end());
  for (const Series& record : records)
    for (const std::string& note : record.notes)
      out.notes.push_back(records.size() > 1 ? fmt::format("{}: {}", record.record, note) : note);
  if (!out.base.fit.ok)
    throw RunError{fmt::format("{}: too little motion to determine the model", records[0].record)};
  judge_gains(found.gains, out);
  measure_left(out.final, records.front(), out.final.law);
  for (const std::string& path : options.validation)
    out.validation.push_back(validate(
        out, read_series(path, found.config, options.skip_bad_lines, options.reference_column)));
  gather_evidence(records, out);
  return std::move(found.explanation);
}

}  // namespace dampline::app::rig

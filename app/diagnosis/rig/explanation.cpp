// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/explanation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "app/diagnosis/common/evidence.hpp"
#include "app/diagnosis/rig/thresholds.hpp"
#include "app/diagnosis/rig/trials.hpp"
#include "app/run/trust.hpp"

namespace dampline::app::rig {
namespace {

app::ModelFound found_of(const Model& model, const std::vector<std::string>& records) {
  app::ModelFound out{model.terms, model.fit.held_out_nmse, model.parameters, {}};
  for (std::size_t r = 0; r < records.size(); ++r)
    out.records.emplace_back(records[r], model.fit.record_nmse[r]);
  return out;
}

constexpr double kSegmentS = 8.0;  // of the spectrum, where the records are long enough
constexpr double kSegmentPoints = 512.0;
constexpr double kLawReach = 2.0;  // of the velocity's rms
constexpr int kLawPoints = 30;     // on each side
constexpr double kLeastTurn = 0.02;
constexpr Eigen::Index kFewestSamples = 200;

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
    if (series.why_left_out(at) == Series::kRest) {
      meter.gap();
      continue;
    }
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

/// Columns in steady sliding at v, undeflected: every friction element has slipped long since.
Eigen::VectorXd sliding(const Model& model, double v) {
  Series slide;
  slide.interval_s = 1.0;
  slide.deflection_m = Eigen::Vector2d{v < 0.0 ? 1.0 : -1.0, 0.0};
  slide.velocity_mps = Eigen::Vector2d{v, v};
  slide.force_n = Eigen::Vector2d::Zero();
  Eigen::VectorXd out = Eigen::VectorXd::Zero(model.fit.theta.size());
  for (std::size_t c = 0; c < model.columns.size(); ++c)
    out[static_cast<Eigen::Index>(c)] = evaluate(model.columns[c], slide)[1];
  return out;
}

double sliding_force(const Model& model, double v) {
  return sliding(model, v).dot(model.fit.theta);
}

Eigen::Index moving_samples(const Series& series) {
  Eigen::Index out = 0;
  for (Eigen::Index i = 0; i < series.size(); ++i) out += series.why_left_out(i) == 0.0 ? 1 : 0;
  return out;
}

/// The final model's coefficients as the first part of the records gives them, again and again.
Convergence convergence_of(const Model& model, const std::vector<Series>& records) {
  constexpr int kRows = 12;
  Convergence out;
  double whole_s = 0.0;
  for (const Series& s : records) whole_s += static_cast<double>(s.size()) * s.interval_s;
  for (const auto& [parameter, place] : model.coefficients) {
    out.names.push_back(model.parameters[parameter].name);
    out.units.push_back(model.parameters[parameter].unit);
  }
  ColumnSet all(model.columns.size());
  std::iota(all.begin(), all.end(), 0);
  for (int row = 1; row <= kRows && !out.names.empty(); ++row) {
    std::vector<Series> seen;
    const double time_s = whole_s * row / kRows;
    double left_s = time_s;
    for (const Series& s : records) {
      const auto count = std::min(s.size(), static_cast<Eigen::Index>(left_s / s.interval_s));
      Series head = seen_by(model, s).part(0, count);
      if (moving_samples(head) >= kFewestSamples) seen.push_back(std::move(head));
      left_s -= static_cast<double>(count) * s.interval_s;
    }
    if (seen.empty()) continue;
    const Fit fit = Regression{model.columns, seen}.fit(all, model.ridge);
    if (!fit.ok || !fit.covariance.allFinite()) continue;
    Convergence::Row& added = out.rows.emplace_back(Convergence::Row{time_s, {}});
    for (const auto& [parameter, place] : model.coefficients)
      added.estimates.push_back(fit.estimate(place));
  }
  return out;
}

/// Forces of the final law in steady sliding in the place of those of `curve`, at its velocities.
void put_law(const Explanation& e, std::vector<CurveRow>& curve) {
  // Columns of a change over the record follow the others and have no deviation of their own here.
  const Eigen::MatrixXd& all = e.final.fit.covariance;
  const Eigen::Index own = all.rows() - static_cast<Eigen::Index>(e.final.changes.size());
  const Eigen::MatrixXd covariance = all.topLeftCorner(own, own);
  double slowest = 0.0;
  for (const CurveRow& row : curve)
    if (row.velocity_mps > 0.0 && (slowest == 0.0 || row.velocity_mps < slowest))
      slowest = row.velocity_mps;
  bool past_zero = false;
  for (CurveRow& row : curve) {
    // Below the slowest node nothing is known of the jump at zero but that it is one.
    const double v = row.velocity_mps != 0.0 ? row.velocity_mps : past_zero ? slowest : -slowest;
    past_zero = past_zero || row.velocity_mps == 0.0;
    const Eigen::VectorXd columns = sliding(e.final, v);
    row.force_n = columns.dot(e.final.fit.theta);
    row.std_n = std::sqrt(std::max(columns.head(own).dot(covariance * columns.head(own)), 0.0));
  }
}

}  // namespace

bool Explanation::is_complete() const noexcept {
  if (!alike.empty() || !impossible.empty()) return false;
  const FreeRunError& run = final.free_run;
  const bool moved = run.segments > 0;
  if (moved && run.followed) return true;
  // More than noise is left of the motion: the law's own fault, unless the force is noisy.
  const bool noise = final.floor_noise_share > kStructured;
  if (moved && run.density_ratio && !noise) return false;
  if (moved && std::min(run.nmse_of_motion, run.nmse_of_equations) > kMisses) return false;
  const double nmse = final.fit.held_out_nmse;
  if (nmse < kNegligible) return true;
  const double noise_nmse = final.floor_noise_share * final.floor_nmse;
  if (nmse - kIncompleteAbove * noise_nmse > kRigMisfit) return false;
  const double above = kMotionAbove + (kIncompleteAbove - kMotionAbove) * final.floor_noise_share;
  const double structured = std::max(signature.travel_share, signature.surface_share);
  return nmse <= above * final.floor_nmse && !(noise && structured > kStructured);
}

const char* Explanation::verdict() const {
  if (steps.empty()) return is_complete() ? "complete" : "unexplained";
  return is_complete() ? "explained" : "partly_explained";
}

namespace {

app::Explanation found_in(const Explanation& e) {
  app::Explanation out;
  out.verdict = e.verdict();
  out.known = {true, !e.is_complete(), false};
  out.base = found_of(e.base, e.records);
  out.final = found_of(e.final, e.records);
  out.steps = e.steps;
  out.rejected = e.rejected;
  out.floor_nmse = e.final.floor_nmse;
  out.floor_by = e.final.floor_by;
  out.left_over_floor = e.final.left_over_floor();
  out.unknown = out.law_incomplete = !e.is_complete();
  out.alike = e.alike;
  if (e.whole_records) out.held_out = "records";
  out.filter_hz = e.filter_hz;
  out.force = e.filter_hz > 0.0 ? "measured, behind the filter of the fit" : "measured";
  out.free_run = e.final.free_run;
  out.validation.assign(e.validation.begin(), e.validation.end());
  out.notes = e.notes;
  out.faults = e.faults;
  out.signature = e.signature;
  out.channels = {"deflection", "velocity", "speed"};
  return out;
}

}  // namespace

app::Explanation conclude(const Explanation& e, RunResult& result) {
  app::Explanation out = found_in(e);
  result.evidence = e.evidence;
  result.notes.insert(result.notes.end(), e.notes.begin(), e.notes.end());
  put_law(e, result.curve);
  if (!e.convergence.rows.empty()) result.convergence = e.convergence;
  put_final(out, result);
  result.evidence.explanation = to_json(out);
  result.law = law::to_json(e.final.law);
  return out;
}

app::Explanation told(const Explanation& e) {
  RunResult result;
  result.kind = "rig";
  return conclude(e, result);
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
  e.convergence = convergence_of(e.final, records);
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

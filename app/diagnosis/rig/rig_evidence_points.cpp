// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/rig_evidence_points.hpp"

#include <algorithm>
#include <cmath>

#include "app/diagnosis/rig/rig_trials.hpp"
#include "app/explain/evidence_meter.hpp"

namespace dampline::app {
namespace {

constexpr double kSegmentS = 8.0;  // of the spectrum, where the records are long enough
constexpr double kSegmentPoints = 512.0;
constexpr double kLawReach = 2.0;  // of the velocity's rms
constexpr int kLawPoints = 30;     // on each side
constexpr double kLeastTurn = 0.02;

/// Samples that become one point: a segment must hold some periods of the motion.
Eigen::Index joined_samples(const std::vector<RigSeries>& records) {
  double shortest_s = 3.0 * kSegmentS;
  for (const RigSeries& s : records)
    shortest_s = std::min(shortest_s, static_cast<double>(s.size()) * s.interval_s);
  const double segment_s = shortest_s / 3.0;
  const double joined = segment_s / (kSegmentPoints * records.front().interval_s);
  return std::max<Eigen::Index>(1, static_cast<Eigen::Index>(joined));
}

EvidenceScale scale_of_points(const std::vector<RigSeries>& records, Eigen::Index joined) {
  EvidenceScale out;
  double count = 0.0;
  double noise_m = 0.0;
  for (const RigSeries& s : records) {
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
void take_record(const RigExplanation& e, const RigSeries& series, double start_s,
                 Eigen::Index joined, EvidenceMeter& meter) {
  const RigRows base = rows_of(e.base.columns, series, 1);
  const RigRows final = rows_of(e.final.columns, seen_by(e.final, series), 1);
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
double sliding_force(const RigModel& model, double v) {
  RigSeries slide;
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

Eigen::VectorXd model_force(const RigModel& model, const RigRows& rows) {
  return rows.values.leftCols(model.fit.theta.size()) * model.fit.theta;
}

RigSeries seen_by(const RigModel& model, const RigSeries& series) {
  RigSeries out = model.skew_s != 0.0 ? delayed(series, model.skew_s) : series;
  out.path = model.path;
  return out;
}

void gather_evidence(const std::vector<RigSeries>& records, RigExplanation& e) {
  const Eigen::Index joined = joined_samples(records);
  const EvidenceScale scale = scale_of_points(records, joined);
  EvidenceMeter meter{scale};
  double start_s = 0.0;
  for (const RigSeries& series : records) {
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
  for (const RigValidated& v : e.validation) {
    ++record;
    for (std::size_t i = 0; i < v.time_s.size(); ++i)
      e.evidence.prediction.push_back(
          {record, v.time_s[i], v.measured_n[i], v.predicted_n[i], v.base_n[i], v.reference_n[i]});
  }
}

}  // namespace dampline::app

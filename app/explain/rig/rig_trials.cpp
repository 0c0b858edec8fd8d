// SPDX-License-Identifier: MIT
#include "app/explain/rig/rig_trials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "app/explain/rig/rig_rank.hpp"

namespace dampline::app {
namespace {

constexpr std::array kSkewSamples{0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0};
constexpr int kRefinements = 4;
constexpr double kLeastSkew = 0.12;  // samples
constexpr int kStepPlaces = 10;

ColumnSet first_columns(std::size_t count) {
  ColumnSet out(count);
  std::iota(out.begin(), out.end(), 0);
  return out;
}

}  // namespace

RigFit best_fit(const std::vector<RigSeries>& records, const RigTrialBase& base,
                const std::vector<RigColumn>& more) {
  std::vector<RigColumn> columns = base.columns;
  columns.insert(columns.end(), more.begin(), more.end());
  const auto first = static_cast<Eigen::Index>(columns.size());
  const ColumnSet others = first_columns(columns.size());
  columns.insert(columns.end(), base.friction.begin(), base.friction.end());
  const RigEvidence evidence{columns, records};
  RigFit best;
  for (std::size_t w = 0; w < std::max<std::size_t>(base.friction.size(), 1); ++w) {
    ColumnSet set = others;
    if (!base.friction.empty()) set.push_back(first + static_cast<Eigen::Index>(w));
    RigFit fit = evidence.fit(set, base.ridge);
    if (fit.ok && (!best.ok || fit.held_out_nmse < best.held_out_nmse)) best = std::move(fit);
  }
  return best;
}

namespace {

RigFit skewed_fit(const std::vector<RigSeries>& records, const RigTrialBase& base, double skew_s) {
  std::vector<RigSeries> moved;
  moved.reserve(records.size());
  for (const RigSeries& r : records) moved.push_back(delayed(r, skew_s));
  return best_fit(moved, base);
}

double between(const Eigen::VectorXd& y, double place) {
  const auto last = static_cast<double>(y.size() - 1);
  const double at = std::clamp(place, 0.0, last);
  const auto i = std::min(static_cast<Eigen::Index>(at), y.size() - 2);
  const double u = at - static_cast<double>(i);
  const double before = y[std::max<Eigen::Index>(i - 1, 0)];
  const double after = y[std::min(i + 2, y.size() - 1)];
  const double a = y[i];
  const double b = y[i + 1];
  const double slope_a = 0.5 * (b - before);
  const double slope_b = 0.5 * (after - a);
  const double square = u * u;
  const double cube = square * u;
  return (2.0 * cube - 3.0 * square + 1.0) * a + (cube - 2.0 * square + u) * slope_a +
         (3.0 * square - 2.0 * cube) * b + (cube - square) * slope_b;
}

const char* drift_name(const RigColumn& column) {
  switch (column.kind) {
    case RigColumn::Kind::kVelocity:
      return "viscous";
    case RigColumn::Kind::kDeflection:
      return "stiffness";
    case RigColumn::Kind::kOne:
      return "offset";
    default:
      return nullptr;
  }
}

struct Drifting {
  RigColumn column;
  const char* name;
};

std::vector<Drifting> what_may_drift(const std::vector<RigSeries>& records,
                                     const RigTrialBase& base) {
  std::vector<Drifting> out;
  for (const RigColumn& c : base.columns)
    if (drift_name(c) != nullptr) out.push_back({c, drift_name(c)});
  RigColumn best;
  double least = -1.0;
  for (const RigColumn& friction : base.friction) {
    const double nmse = best_fit(records, {base.columns, {friction}, base.ridge}).held_out_nmse;
    if (least >= 0.0 && nmse >= least) continue;
    least = nmse;
    best = friction;
  }
  if (least >= 0.0) out.push_back({best, "coulomb"});
  return out;
}

}  // namespace

RigSeries delayed(const RigSeries& record, double skew_s) {
  RigSeries out = record;
  const double samples = skew_s / record.interval_s;
  for (Eigen::Index i = 0; i < record.size(); ++i) {
    out.deflection_m[i] = between(record.deflection_m, static_cast<double>(i) - samples);
    out.velocity_mps[i] = between(record.velocity_mps, static_cast<double>(i) - samples);
  }
  return out;
}

std::optional<RigTrial> try_skew(const std::vector<RigSeries>& records, const RigTrialBase& base) {
  const double interval_s = records.front().interval_s;
  const RigFit without = best_fit(records, base);
  if (!without.ok) return std::nullopt;
  RigTrial best;
  best.effect = "time_skew";
  best.fit = without;
  const auto look = [&](double skew_s) {
    RigFit fit = skewed_fit(records, base, skew_s);
    if (!fit.ok || fit.held_out_nmse >= best.fit.held_out_nmse) return;
    best.fit = std::move(fit);
    best.skew_s = skew_s;
  };
  for (const double samples : kSkewSamples) {
    look(samples * interval_s);
    look(-samples * interval_s);
  }
  double step_s = 0.25 * std::max(std::abs(best.skew_s), 0.25 * interval_s);
  for (int i = 0; i < kRefinements; ++i, step_s *= 0.5) {
    const double middle_s = best.skew_s;
    look(middle_s - step_s);
    look(middle_s + step_s);
  }
  if (std::abs(best.skew_s) < kLeastSkew * interval_s) return std::nullopt;
  best.gain = 1.0 - best.fit.held_out_nmse / without.held_out_nmse;
  best.t = block_t(without, best.fit);
  return best;
}

double skew_deviation(const std::vector<RigSeries>& records, const RigTrialBase& base,
                      double skew_s) {
  const double step_s = 0.2 * records.front().interval_s;
  const RigFit low = skewed_fit(records, base, skew_s - step_s);
  const RigFit middle = skewed_fit(records, base, skew_s);
  const RigFit high = skewed_fit(records, base, skew_s + step_s);
  if (!low.ok || !middle.ok || !high.ok) return step_s;
  const double curve = high.held_out_nmse - 2.0 * middle.held_out_nmse + low.held_out_nmse;
  if (!(curve > 0.0)) return step_s;
  const auto n = static_cast<double>(middle.block_error.size());
  double squares = 0.0;
  const double mean = 0.5 * (high.held_out_nmse - low.held_out_nmse);
  for (std::size_t b = 0; b < middle.block_error.size(); ++b) {
    const double slope = 0.5 * (high.block_error[b] - low.block_error[b]) - mean;
    squares += slope * slope;
  }
  return step_s * std::sqrt(squares / (n * (n - 1.0))) / curve;
}

std::optional<RigTrial> try_drift(const std::vector<RigSeries>& records, const RigTrialBase& base) {
  std::vector<RigColumn> columns = base.columns;
  columns.insert(columns.end(), base.friction.begin(), base.friction.end());
  const RigFit without = best_fit(records, base);
  if (!without.ok) return std::nullopt;
  RigTrial best;
  best.effect = "time_drift";
  best.fit = without;
  for (const Drifting& drifting : what_may_drift(records, base)) {
    for (int place = 0; place < kStepPlaces; ++place) {
      RigColumn column = drifting.column;
      column.time = place == 0 ? RigColumn::Time::kSlope : RigColumn::Time::kStep;
      column.at = static_cast<double>(place) / kStepPlaces;
      RigFit fit = best_fit(records, base, {column});
      if (!fit.ok || fit.held_out_nmse >= best.fit.held_out_nmse) continue;
      best.fit = std::move(fit);
      best.columns = {column};
      best.parameter = drifting.name;
      best.at_share = place == 0 ? -1.0 : column.at;
    }
  }
  if (best.columns.empty()) return std::nullopt;
  best.gain = 1.0 - best.fit.held_out_nmse / without.held_out_nmse;
  best.t = block_t(without, best.fit);
  return best;
}

}  // namespace dampline::app

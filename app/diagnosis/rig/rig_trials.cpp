// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/rig_trials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "app/diagnosis/rig/rig_rank.hpp"

namespace dampline::app {
namespace {

constexpr std::array kSkewSamples{0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0};
constexpr int kRefinements = 4;
constexpr double kWorthALook = 0.95;
constexpr std::size_t kLooks = 3;
constexpr double kLeastSkew = 0.12;  // samples
constexpr std::size_t kStepPlaces = 10;

std::vector<RigColumn> all_columns(const RigTrialBase& base, std::vector<RigColumn> more) {
  std::vector<RigColumn> out = base.columns;
  out.insert(out.end(), base.friction.begin(), base.friction.end());
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

}  // namespace

TrialFits::TrialFits(const std::vector<RigSeries>& records, const RigTrialBase& base,
                     std::vector<RigColumn> more)
    : base_{base}, evidence_{all_columns(base, std::move(more)), records} {}

RigFit TrialFits::fit(const ColumnSet& more, std::size_t friction) const {
  const std::size_t first = base_.columns.size();
  ColumnSet set(first);
  std::iota(set.begin(), set.end(), 0);
  for (const Eigen::Index i : more)
    set.push_back(static_cast<Eigen::Index>(first + base_.friction.size()) + i);
  if (!base_.friction.empty()) set.push_back(static_cast<Eigen::Index>(first + friction));
  return evidence_.fit(set, base_.ridge);
}

RigFit TrialFits::best(const ColumnSet& more) const {
  RigFit out;
  for (std::size_t w = 0; w < std::max<std::size_t>(base_.friction.size(), 1); ++w) {
    RigFit now = fit(more, w);
    if (now.ok && (!out.ok || now.held_out_nmse < out.held_out_nmse)) out = std::move(now);
  }
  return out;
}

TrialFits::Best TrialFits::best_positive(std::size_t count) const {
  const auto place = static_cast<Eigen::Index>(base_.columns.size());
  Best out;
  for (std::size_t c = 0; c < count; ++c) {
    RigFit now = best({static_cast<Eigen::Index>(c)});
    if (!now.ok || !(now.theta[place] > 0.0)) continue;
    if (out.fit.ok && now.held_out_nmse >= out.fit.held_out_nmse) continue;
    out = {c, std::move(now)};
  }
  return out;
}

std::optional<RigColumn> TrialFits::friction() const {
  std::optional<RigColumn> out;
  double least = 0.0;
  for (std::size_t w = 0; w < base_.friction.size(); ++w) {
    const RigFit now = fit({}, w);
    if (!now.ok || (out && now.held_out_nmse >= least)) continue;
    least = now.held_out_nmse;
    out = base_.friction[w];
  }
  return out;
}

RigFit best_fit(const std::vector<RigSeries>& records, const RigTrialBase& base) {
  return TrialFits{records, base}.best();
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
  if (const auto friction = TrialFits{records, base}.friction())
    out.push_back({*friction, "coulomb"});
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
    const double nmse = fit.ok ? fit.held_out_nmse : without.held_out_nmse;
    if (nmse >= best.fit.held_out_nmse) return nmse;
    best.fit = std::move(fit);
    best.skew_s = skew_s;
    return nmse;
  };
  std::vector<std::pair<double, double>> order;  // error, skew
  for (const double samples : kSkewSamples)
    for (const double skew_s : {samples * interval_s, -samples * interval_s})
      order.emplace_back(look(skew_s), skew_s);
  std::sort(order.begin(), order.end());
  // A sharp friction makes a narrow hollow, which the grid may pass by.
  if (best.fit.held_out_nmse < kWorthALook * without.held_out_nmse)
    for (std::size_t i = 0; i < kLooks; ++i)
      for (const double part : {-0.25, -0.125, 0.125, 0.25}) {
        const double step_s = part * std::max(std::abs(order[i].second), interval_s);
        look(order[i].second + step_s);
      }
  double step_s = 0.0625 * std::max(std::abs(best.skew_s), interval_s);
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
  return deviation_of(low, middle, high, step_s);
}

double deviation_of(const RigFit& low, const RigFit& middle, const RigFit& high, double step) {
  if (!low.ok || !middle.ok || !high.ok) return step;
  const double curve = high.held_out_nmse - 2.0 * middle.held_out_nmse + low.held_out_nmse;
  if (!(curve > 0.0)) return step;
  const auto n = static_cast<double>(middle.block_error.size());
  double squares = 0.0;
  const double mean = 0.5 * (high.held_out_nmse - low.held_out_nmse);
  for (std::size_t b = 0; b < middle.block_error.size(); ++b) {
    const double slope = 0.5 * (high.block_error[b] - low.block_error[b]) - mean;
    squares += slope * slope;
  }
  return step * std::sqrt(squares / (n * (n - 1.0))) / curve;
}

std::optional<RigTrial> try_drift(const std::vector<RigSeries>& records, const RigTrialBase& base) {
  const std::vector<Drifting> drifting = what_may_drift(records, base);
  std::vector<RigColumn> columns;
  for (const Drifting& d : drifting) {
    for (std::size_t place = 0; place < kStepPlaces; ++place) {
      columns.push_back(d.column);
      columns.back().time = place == 0 ? RigColumn::Time::kSlope : RigColumn::Time::kStep;
      columns.back().at = static_cast<double>(place) / kStepPlaces;
    }
  }
  const TrialFits fits{records, base, columns};
  const RigFit without = fits.best();
  if (!without.ok) return std::nullopt;
  RigTrial best;
  best.effect = "time_drift";
  best.fit = without;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    RigFit fit = fits.best({static_cast<Eigen::Index>(c)});
    if (!fit.ok || fit.held_out_nmse >= best.fit.held_out_nmse) continue;
    best.fit = std::move(fit);
    best.columns = {columns[c]};
    best.parameter = drifting[c / kStepPlaces].name;
    best.at_share = columns[c].time == RigColumn::Time::kSlope ? -1.0 : columns[c].at;
  }
  if (best.columns.empty()) return std::nullopt;
  best.gain = 1.0 - best.fit.held_out_nmse / without.held_out_nmse;
  best.t = block_t(without, best.fit);
  return best;
}

}  // namespace dampline::app

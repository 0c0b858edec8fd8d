// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/trials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "app/diagnosis/rig/library.hpp"
#include "app/diagnosis/rig/regression.hpp"

namespace dampline::app::rig {
namespace {

constexpr std::array kSkewSamples{0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0};
constexpr int kSkewRefinements = 4;
constexpr double kWorthALook = 0.95;
constexpr std::size_t kLooks = 3;
constexpr double kLeastSkew = 0.12;  // samples

std::vector<Regressor> all_columns(const TrialBase& base, std::vector<Regressor> more) {
  std::vector<Regressor> out = base.columns;
  out.insert(out.end(), base.friction.begin(), base.friction.end());
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

Fit skewed_fit(const std::vector<Series>& records, const TrialBase& base, double skew_s) {
  std::vector<Series> moved;
  moved.reserve(records.size());
  for (const Series& r : records) moved.push_back(delayed(r, skew_s));
  return best_fit(moved, base);
}

const char* drift_name(const Regressor& column) {
  switch (column.kind) {
    case Kind::kVelocity:
      return "viscous";
    case Kind::kDeflection:
      return "stiffness";
    case Kind::kOne:
      return "offset";
    default:
      return nullptr;
  }
}

struct Drifting {
  Regressor column;
  const char* name;
};

std::vector<Drifting> what_may_drift(const std::vector<Series>& records, const TrialBase& base) {
  std::vector<Drifting> out;
  for (const Regressor& c : base.columns)
    if (drift_name(c) != nullptr) out.push_back({c, drift_name(c)});
  if (const auto friction = TrialFits{records, base}.friction())
    out.push_back({*friction, "coulomb"});
  return out;
}

constexpr double kLongestStep = 0.05;  // of the travel
constexpr int kMostParts = 20;
constexpr double kShortest = 0.01;  // of the deflection
constexpr double kLongest = 4.0;
constexpr double kRatio = 1.5;
constexpr std::array kShapes{-1.5, -1.0, -0.5, 0.0, 0.5, 1.0};
constexpr double kShapeStep = 0.5;
constexpr int kRounds = 6;

/// Lagrange's polynomial through the six samples about i - 1 + part / parts; a straight line at the
/// ends.
double between_parts(const Eigen::VectorXd& x, Eigen::Index i, int part, int parts) {
  const double u = static_cast<double>(part) / parts;
  if (i < 3 || i + 2 >= x.size()) return x[i - 1] + u * (x[i] - x[i - 1]);
  double sum = 0.0;
  for (int k = -2; k <= 3; ++k) {
    double weight = 1.0;
    for (int j = -2; j <= 3; ++j)
      if (j != k) weight *= (u - j) / (k - j);
    sum += weight * x[i - 1 + k];
  }
  return sum;
}

/// What moves at the start has slipped; what rests, and what never slips, starts from 0.
double start_of(const Eigen::VectorXd& x, double travel_m, double shape) {
  constexpr double kMoves = 0.3;  // of the rms of the speed
  const Eigen::Index last = x.size() - 1;
  if (last < 1) return 0.0;
  const double rms_m =
      std::sqrt((x.tail(last) - x.head(last)).squaredNorm() / static_cast<double>(last));
  const double first_m = x[1] - x[0];
  return std::abs(first_m) < kMoves * rms_m
             ? 0.0
             : std::copysign(bouc_wen_slip_m(travel_m, shape), first_m);
}

/// Every column in turn beside the base; a spring that pushes is no hysteresis.
void look(const std::vector<Series>& records, const TrialBase& base,
          const std::vector<Regressor>& columns, BestColumn& best) {
  const TrialFits fits{records, base, columns};
  auto [place, fit] = fits.best_positive(columns.size());
  if (fit.beats(best.fit)) best = {columns[place], std::move(fit)};
}

/// A look at the neighbours; whether one of them was clearly better.
bool move(const std::vector<Series>& records, const TrialBase& base, double ratio, double step,
          BestColumn& best) {
  constexpr double kWorthwhile = 0.995;
  const Regressor from = best.column;
  const double before = best.fit.held_out_nmse;
  std::vector<Regressor> columns;
  for (const double times : {1.0 / ratio, 1.0, ratio}) {
    columns.push_back({from.kind, times * from.a, from.b});
    for (const double more : {-step, step})
      if (more != 0.0) columns.push_back({from.kind, times * from.a, from.b + more});
  }
  look(records, base, columns, best);
  return best.fit.held_out_nmse < kWorthwhile * before;
}

/// Between the points of a grid.
void refine(const std::vector<Series>& records, const TrialBase& base, double ratio, double step,
            BestColumn& best) {
  for (int i = 0; i < kRounds; ++i) {
    ratio = std::sqrt(ratio);
    step *= 0.5;
    while (move(records, base, ratio, step, best)) {
    }
  }
}

}  // namespace

TrialFits::TrialFits(const std::vector<Series>& records, const TrialBase& base,
                     std::vector<Regressor> more)
    : base_{base}, evidence_{all_columns(base, std::move(more)), records} {}

Fit TrialFits::fit(const ColumnSet& more, std::size_t friction) const {
  const std::size_t first = base_.columns.size();
  ColumnSet set(first);
  std::iota(set.begin(), set.end(), 0);
  for (const Eigen::Index i : more)
    set.push_back(static_cast<Eigen::Index>(first + base_.friction.size()) + i);
  if (!base_.friction.empty()) set.push_back(static_cast<Eigen::Index>(first + friction));
  return evidence_.fit(set, base_.ridge);
}

Fit TrialFits::best(const ColumnSet& more) const {
  Fit out;
  for (std::size_t w = 0; w < std::max<std::size_t>(base_.friction.size(), 1); ++w) {
    Fit now = fit(more, w);
    if (now.beats(out)) out = std::move(now);
  }
  return out;
}

TrialFits::Best TrialFits::best_positive(std::size_t count) const {
  const auto place = static_cast<Eigen::Index>(base_.columns.size());
  Best out;
  for (std::size_t c = 0; c < count; ++c) {
    Fit now = best({static_cast<Eigen::Index>(c)});
    if (now.beats(out.fit) && now.theta[place] > 0.0) out = {c, std::move(now)};
  }
  return out;
}

std::optional<Regressor> TrialFits::friction() const {
  std::optional<Regressor> out;
  Fit best;
  for (std::size_t w = 0; w < base_.friction.size(); ++w) {
    Fit now = fit({}, w);
    if (!now.beats(best)) continue;
    best = std::move(now);
    out = base_.friction[w];
  }
  return out;
}

Fit best_fit(const std::vector<Series>& records, const TrialBase& base) {
  return TrialFits{records, base}.best();
}

Series delayed(const Series& record, double skew_s) {
  Series out = record;
  const double samples = skew_s / record.interval_s;
  for (Eigen::Index i = 0; i < record.size(); ++i) {
    out.deflection_m[i] = between(record.deflection_m, static_cast<double>(i) - samples);
    out.velocity_mps[i] = between(record.velocity_mps, static_cast<double>(i) - samples);
  }
  return out;
}

std::optional<Trial> try_skew(const std::vector<Series>& records, const TrialBase& base) {
  const double interval_s = records.front().interval_s;
  const Fit without = best_fit(records, base);
  if (!without.ok) return std::nullopt;
  Trial best;
  best.effect = "time_skew";
  best.fit = without;
  const auto look = [&](double skew_s) {
    Fit fit = skewed_fit(records, base, skew_s);
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
  for (int i = 0; i < kSkewRefinements; ++i, step_s *= 0.5) {
    const double middle_s = best.skew_s;
    look(middle_s - step_s);
    look(middle_s + step_s);
  }
  if (std::abs(best.skew_s) < kLeastSkew * interval_s) return std::nullopt;
  best.judge(without, best.fit);
  return best;
}

std::optional<Trial> try_drift(const std::vector<Series>& records, const TrialBase& base) {
  const std::vector<Drifting> drifting = what_may_drift(records, base);
  std::vector<Regressor> columns;
  const std::vector<double> places = places_of_steps(records);
  for (const Drifting& d : drifting) {
    columns.push_back(d.column);
    columns.back().time = Regressor::Time::kSlope;
    for (const double place : places) {
      columns.push_back(d.column);
      columns.back().time = Regressor::Time::kStep;
      columns.back().at = place;
    }
  }
  const TrialFits fits{records, base, columns};
  const Fit without = fits.best();
  if (!without.ok) return std::nullopt;
  Trial best;
  best.effect = "time_drift";
  best.fit = without;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    Fit fit = fits.best({static_cast<Eigen::Index>(c)});
    if (!fit.beats(best.fit)) continue;
    best.fit = std::move(fit);
    best.columns = {columns[c]};
    best.parameter = drifting[c / (1 + places.size())].name;
    best.at_share = columns[c].time == Regressor::Time::kSlope ? -1.0 : columns[c].at;
  }
  if (best.columns.empty()) return std::nullopt;
  best.judge(without, best.fit);
  return best;
}

double bouc_wen_slip_m(double travel_m, double shape) {
  constexpr double kSlips = 0.1;  // a smaller one is not reached within ten travels
  return 1.0 + shape < kSlips ? 0.0 : travel_m / (1.0 + shape);
}

Eigen::VectorXd bouc_wen(const Eigen::VectorXd& deflection_m, double travel_m, double shape) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(deflection_m.size());
  double z = start_of(deflection_m, travel_m, shape);
  if (out.size() > 0) out[0] = z;
  const auto move = [&](double dx) {
    const auto slope = [&](double at) {
      return dx - (std::abs(dx) * at + shape * dx * std::abs(at)) / travel_m;
    };
    z += slope(z + 0.5 * slope(z));
  };
  for (Eigen::Index i = 1; i < deflection_m.size(); ++i) {
    const double whole_m = deflection_m[i] - deflection_m[i - 1];
    const int parts = std::clamp(
        static_cast<int>(std::ceil(std::abs(whole_m) / (kLongestStep * travel_m))), 1, kMostParts);
    double from_m = deflection_m[i - 1];
    for (int p = 1; p <= parts; ++p) {
      const double to_m = p < parts ? between_parts(deflection_m, i, p, parts) : deflection_m[i];
      move(to_m - from_m);
      from_m = to_m;
    }
    out[i] = z;
  }
  return out;
}

std::optional<BestColumn> best_bouc_wen(const std::vector<Series>& records, const TrialBase& base,
                                        double deflection_m) {
  std::vector<Regressor> columns;
  for (const double share : ratios(kShortest, kLongest, kRatio))
    for (const double shape : kShapes)
      columns.push_back({Kind::kBoucWen, share * deflection_m, shape});
  BestColumn best;
  look(records, base, columns, best);
  if (!best.fit.ok) return std::nullopt;
  refine(records, base, kRatio, kShapeStep, best);
  return best;
}

std::optional<BestColumn> best_viscoelastic(const std::vector<Series>& records,
                                            const TrialBase& base,
                                            const std::vector<double>& times_s) {
  std::vector<Regressor> columns;
  columns.reserve(times_s.size());
  for (const double time_s : times_s) columns.push_back({Kind::kMaxwell, time_s});
  BestColumn best;
  if (!columns.empty()) look(records, base, columns, best);
  if (!best.fit.ok) return std::nullopt;
  refine(records, base, kRatio, 0.0, best);
  return best;
}

}  // namespace dampline::app::rig

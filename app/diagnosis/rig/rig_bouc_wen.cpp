// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/rig_bouc_wen.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "app/diagnosis/rig/rig_library.hpp"

namespace dampline::app {
namespace {

constexpr double kLongestStep = 0.05;  // of the travel
constexpr int kMostParts = 20;
constexpr double kShortest = 0.01;  // of the deflection
constexpr double kLongest = 4.0;
constexpr double kRatio = 1.5;
constexpr std::array kShapes{-1.5, -1.0, -0.5, 0.0, 0.5, 1.0};
constexpr double kShapeStep = 0.5;
constexpr int kRounds = 6;

struct Best {
  RigColumn column;
  RigFit fit;
};

/// Lagrange's polynomial through the six samples about i - 1 + part / parts; a straight line at the
/// ends.
double between(const Eigen::VectorXd& x, Eigen::Index i, int part, int parts) {
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
void look(const std::vector<RigSeries>& records, const RigTrialBase& base,
          const std::vector<RigColumn>& columns, Best& best) {
  const TrialFits fits{records, base, columns};
  auto [place, fit] = fits.best_positive(columns.size());
  if (fit.ok && !(best.fit.ok && fit.held_out_nmse >= best.fit.held_out_nmse))
    best = {columns[place], std::move(fit)};
}

/// A look at the neighbours; whether one of them was clearly better.
bool move(const std::vector<RigSeries>& records, const RigTrialBase& base, double ratio,
          double step, Best& best) {
  constexpr double kWorthwhile = 0.995;
  const RigColumn from = best.column;
  const double before = best.fit.held_out_nmse;
  std::vector<RigColumn> columns;
  for (const double times : {1.0 / ratio, 1.0, ratio})
    for (const double more : {-step, 0.0, step})
      columns.push_back({from.kind, times * from.a, from.b + more});
  look(records, base, columns, best);
  return best.fit.held_out_nmse < kWorthwhile * before;
}

/// Deviations from the fits a step to either side of what was found.
BoucWen with_deviations(const std::vector<RigSeries>& records, const RigTrialBase& base,
                        const Best& best) {
  constexpr double kStep = 0.05;
  const RigColumn& at = best.column;
  const double travel_step_m = kStep * at.a;
  const TrialFits fits{records,
                       base,
                       {at,
                        {at.kind, at.a - travel_step_m, at.b},
                        {at.kind, at.a + travel_step_m, at.b},
                        {at.kind, at.a, at.b - kStep},
                        {at.kind, at.a, at.b + kStep}}};
  const RigFit middle = fits.best({0});
  return {at, middle, deviation_of(fits.best({1}), middle, fits.best({2}), travel_step_m),
          deviation_of(fits.best({3}), middle, fits.best({4}), kStep)};
}

}  // namespace

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
      const double to_m = p < parts ? between(deflection_m, i, p, parts) : deflection_m[i];
      move(to_m - from_m);
      from_m = to_m;
    }
    out[i] = z;
  }
  return out;
}

std::optional<BoucWen> best_bouc_wen(const std::vector<RigSeries>& records,
                                     const RigTrialBase& base, double deflection_m) {
  std::vector<RigColumn> columns;
  for (const double share : ratios(kShortest, kLongest, kRatio))
    for (const double shape : kShapes)
      columns.push_back({RigColumn::Kind::kBoucWen, share * deflection_m, shape});
  Best best;
  look(records, base, columns, best);
  if (!best.fit.ok) return std::nullopt;
  double ratio = std::sqrt(kRatio);
  double step = 0.5 * kShapeStep;
  for (int i = 0; i < kRounds; ++i) {
    while (move(records, base, ratio, step, best)) {
    }
    ratio = std::sqrt(ratio);
    step *= 0.5;
  }
  return with_deviations(records, base, best);
}

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "app/diagnosis/rig/library.hpp"
#include "app/diagnosis/rig/regression.hpp"
#include "app/diagnosis/rig/trials.hpp"

namespace dampline::app::rig {
namespace {

constexpr std::array kAttachedDampings{0.03, 0.15};
constexpr std::array kPathDampings{0.04, 0.15};
constexpr double kAttachedRatio = 1.15;
constexpr double kPathRatio = 1.3;
constexpr double kPathSlowest = 1.5;
constexpr double kSlowest = 0.5;   // of the motion's mean frequency
constexpr double kFastest = 40.0;  // above that an attached mass only moves along
constexpr double kOfRate = 0.4;
constexpr int kModeRefinements = 5;
constexpr double kMostDamping = 0.5;
constexpr double kLeastDamping = 0.002;
constexpr double kNoResonance = 0.7;
constexpr double kResonates = 0.85;  // of what a lag without a resonance leaves
constexpr double kResonanceSignificant = 3.0;

double mean_hz(const std::vector<Series>& records) {
  double velocity = 0.0;
  double deflection = 0.0;
  for (const Series& r : records) {
    velocity += r.velocity_mps.squaredNorm();
    deflection += (r.deflection_m.array() - r.deflection_m.mean()).square().sum();
  }
  return std::sqrt(velocity / deflection) / (2.0 * std::numbers::pi);
}

double highest_hz(const std::vector<Series>& records) {
  return kOfRate / records.front().interval_s;
}

/// A few ways to write sign v instead of all: a grid of modes is long.
std::vector<Regressor> few_of(const TrialBase& base, const TrialFits& fits) {
  const std::optional<Regressor> best = fits.friction();
  if (!best) return {};
  std::vector<Regressor> out{*best};
  const auto sign = std::find_if(base.friction.begin(), base.friction.end(),
                                 [](const Regressor& c) { return c.kind == Kind::kSign; });
  if (sign != base.friction.end()) out.push_back(*sign);
  return out;
}

Fit fit_behind(const std::vector<Series>& records, const TrialBase& base, const Mode& mode) {
  std::vector<Series> behind = records;
  for (Series& r : behind) r.path = mode;
  return best_fit(behind, base);
}

Fit fit_attached(const std::vector<Series>& records, const TrialBase& base, const Mode& mode) {
  return TrialFits{records, base, {{Kind::kAttached, mode.hz, mode.damping}}}.best({0});
}

using FitOf = std::function<Fit(const Mode&)>;

struct Found {
  Mode mode;
  Fit fit;
};

/// From the best of a grid on: frequency and damping in turn, in ever smaller steps.
void refine(const FitOf& fit_of, double ratio, double highest, Found& best) {
  const auto look = [&](const Mode& mode) {
    if (mode.hz > highest || mode.damping > kMostDamping || mode.damping < kLeastDamping) return;
    Fit fit = fit_of(mode);
    if (fit.beats(best.fit)) best = {mode, std::move(fit)};
  };
  double hz_ratio = std::sqrt(ratio);
  double damping_ratio = 2.0;
  for (int i = 0; i < kModeRefinements; ++i) {
    const Mode at = best.mode;
    look({at.hz * hz_ratio, at.damping});
    look({at.hz / hz_ratio, at.damping});
    const Mode then = best.mode;
    look({then.hz, then.damping * damping_ratio});
    look({then.hz, then.damping / damping_ratio});
    hz_ratio = std::sqrt(hz_ratio);
    damping_ratio = std::sqrt(damping_ratio);
  }
}

Trial trial_of(const Found& found, const Fit& without) {
  Trial out;
  out.effect = "unmodelled_mode";
  out.mode = found.mode;
  out.judge(without, found.fit);
  return out;
}

}  // namespace

std::optional<Trial> try_attached(const std::vector<Series>& records, const TrialBase& base) {
  const double mean = mean_hz(records);
  const double highest = std::min(highest_hz(records), kFastest * mean);
  const std::vector<double> grid = ratios(kSlowest * mean, highest, kAttachedRatio);
  std::vector<Regressor> columns;
  for (const double damping : kAttachedDampings)
    for (const double hz : grid) columns.push_back({Kind::kAttached, hz, damping});
  const TrialFits fits{records, base, columns};
  const Fit without = fits.best();
  auto [place, fit] = fits.best_positive(columns.size());
  if (!without.ok || !fit.beats(without)) return std::nullopt;
  Found best{{columns[place].a, columns[place].b}, std::move(fit)};
  refine([&](const Mode& m) { return fit_attached(records, base, m); }, kAttachedRatio, highest,
         best);
  Trial out = trial_of(best, without);
  out.columns = {{Kind::kAttached, best.mode.hz, best.mode.damping}};
  return out;
}

std::optional<Trial> try_path(const std::vector<Series>& records, const TrialBase& base) {
  const double highest = highest_hz(records);
  const TrialFits fits{records, base};
  const TrialBase few{base.columns, few_of(base, fits), base.ridge};
  const Fit without = fits.best();
  Found best;
  Found lag;
  for (const double hz : ratios(kPathSlowest * mean_hz(records), highest, kPathRatio)) {
    const auto look = [&](double damping, Found& into) {
      Fit fit = fit_behind(records, few, {hz, damping});
      if (fit.beats(into.fit)) into = {{hz, damping}, std::move(fit)};
    };
    for (const double damping : kPathDampings) look(damping, best);
    look(kNoResonance, lag);
  }
  if (!lag.fit.ok || !without.ok || !best.fit.beats(without)) return std::nullopt;
  refine([&](const Mode& m) { return fit_behind(records, few, m); }, kPathRatio, highest, best);
  best.fit = fit_behind(records, base, best.mode);
  lag.fit = fit_behind(records, base, lag.mode);
  if (best.fit.held_out_nmse > kResonates * lag.fit.held_out_nmse ||
      block_t(lag.fit, best.fit) < kResonanceSignificant)
    return std::nullopt;
  return trial_of(best, without);
}

}  // namespace dampline::app::rig

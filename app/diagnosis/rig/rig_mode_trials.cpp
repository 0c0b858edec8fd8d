// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "app/diagnosis/rig/rig_library.hpp"
#include "app/diagnosis/rig/rig_rank.hpp"
#include "app/diagnosis/rig/rig_trials.hpp"

namespace dampline::app {
namespace {

using Kind = RigColumn::Kind;

constexpr std::array kAttachedDampings{0.03, 0.15};
constexpr std::array kPathDampings{0.04, 0.15};
constexpr double kAttachedRatio = 1.15;
constexpr double kPathRatio = 1.3;
constexpr double kPathSlowest = 1.5;
constexpr double kSlowest = 0.5;   // of the motion's mean frequency
constexpr double kFastest = 40.0;  // above that an attached mass only moves along
constexpr double kOfRate = 0.4;
constexpr int kRefinements = 5;
constexpr double kMostDamping = 0.5;
constexpr double kLeastDamping = 0.002;
constexpr double kNoResonance = 0.7;
constexpr double kResonates = 0.85;  // of what a lag without a resonance leaves
constexpr double kSignificant = 3.0;
constexpr double kStep = 0.01;  // of a frequency, for its deviation

double mean_hz(const std::vector<RigSeries>& records) {
  double velocity = 0.0;
  double deflection = 0.0;
  for (const RigSeries& r : records) {
    velocity += r.velocity_mps.squaredNorm();
    deflection += (r.deflection_m.array() - r.deflection_m.mean()).square().sum();
  }
  return std::sqrt(velocity / deflection) / (2.0 * std::numbers::pi);
}

double highest_hz(const std::vector<RigSeries>& records) {
  return kOfRate / records.front().interval_s;
}

/// A few ways to write sign v instead of all: a grid of modes is long.
std::vector<RigColumn> few_of(const RigTrialBase& base, const TrialFits& fits) {
  const std::optional<RigColumn> best = fits.friction();
  if (!best) return {};
  std::vector<RigColumn> out{*best};
  const auto sign = std::find_if(base.friction.begin(), base.friction.end(),
                                 [](const RigColumn& c) { return c.kind == Kind::kSign; });
  if (sign != base.friction.end()) out.push_back(*sign);
  return out;
}

RigFit fit_behind(const std::vector<RigSeries>& records, const RigTrialBase& base,
                  const RigMode& mode) {
  std::vector<RigSeries> behind = records;
  for (RigSeries& r : behind) r.path = mode;
  return best_fit(behind, base);
}

RigFit fit_attached(const std::vector<RigSeries>& records, const RigTrialBase& base,
                    const RigMode& mode) {
  return TrialFits{records, base, {{Kind::kAttached, mode.hz, mode.damping}}}.best({0});
}

using FitOf = std::function<RigFit(const RigMode&)>;

struct Found {
  RigMode mode;
  RigFit fit;
};

/// From the best of a grid on: frequency and damping in turn, in ever smaller steps.
void refine(const FitOf& fit_of, double ratio, double highest, Found& best) {
  const auto look = [&](const RigMode& mode) {
    if (mode.hz > highest || mode.damping > kMostDamping || mode.damping < kLeastDamping) return;
    RigFit fit = fit_of(mode);
    if (!fit.ok || fit.held_out_nmse >= best.fit.held_out_nmse) return;
    best = {mode, std::move(fit)};
  };
  double hz_ratio = std::sqrt(ratio);
  double damping_ratio = 2.0;
  for (int i = 0; i < kRefinements; ++i) {
    const RigMode at = best.mode;
    look({at.hz * hz_ratio, at.damping});
    look({at.hz / hz_ratio, at.damping});
    const RigMode then = best.mode;
    look({then.hz, then.damping * damping_ratio});
    look({then.hz, then.damping / damping_ratio});
    hz_ratio = std::sqrt(hz_ratio);
    damping_ratio = std::sqrt(damping_ratio);
  }
}

RigTrial trial_of(const Found& found, const RigFit& without) {
  RigTrial out;
  out.effect = "unmodelled_mode";
  out.fit = found.fit;
  out.mode = found.mode;
  out.gain = 1.0 - found.fit.held_out_nmse / without.held_out_nmse;
  out.t = block_t(without, found.fit);
  return out;
}

}  // namespace

std::optional<RigTrial> try_attached(const std::vector<RigSeries>& records,
                                     const RigTrialBase& base) {
  const double mean = mean_hz(records);
  const double highest = std::min(highest_hz(records), kFastest * mean);
  const std::vector<double> grid = ratios(kSlowest * mean, highest, kAttachedRatio);
  std::vector<RigColumn> columns;
  for (const double damping : kAttachedDampings)
    for (const double hz : grid) columns.push_back({Kind::kAttached, hz, damping});
  const TrialFits fits{records, base, columns};
  const RigFit without = fits.best();
  auto [place, fit] = fits.best_positive(columns.size());
  if (!fit.ok || !without.ok || fit.held_out_nmse >= without.held_out_nmse) return std::nullopt;
  Found best{{columns[place].a, columns[place].b}, std::move(fit)};
  refine([&](const RigMode& m) { return fit_attached(records, base, m); }, kAttachedRatio, highest,
         best);
  RigTrial out = trial_of(best, without);
  out.columns = {{Kind::kAttached, best.mode.hz, best.mode.damping}};
  return out;
}

std::optional<RigTrial> try_path(const std::vector<RigSeries>& records, const RigTrialBase& base) {
  const double highest = highest_hz(records);
  const TrialFits fits{records, base};
  const RigTrialBase few{base.columns, few_of(base, fits), base.ridge};
  const RigFit without = fits.best();
  Found best;
  Found lag;
  for (const double hz : ratios(kPathSlowest * mean_hz(records), highest, kPathRatio)) {
    const auto look = [&](double damping, Found& into) {
      RigFit fit = fit_behind(records, few, {hz, damping});
      if (!fit.ok || (into.fit.ok && fit.held_out_nmse >= into.fit.held_out_nmse)) return;
      into = {{hz, damping}, std::move(fit)};
    };
    for (const double damping : kPathDampings) look(damping, best);
    look(kNoResonance, lag);
  }
  if (!best.fit.ok || !lag.fit.ok || !without.ok) return std::nullopt;
  if (best.fit.held_out_nmse >= without.held_out_nmse) return std::nullopt;
  refine([&](const RigMode& m) { return fit_behind(records, few, m); }, kPathRatio, highest, best);
  best.fit = fit_behind(records, base, best.mode);
  lag.fit = fit_behind(records, base, lag.mode);
  if (best.fit.held_out_nmse > kResonates * lag.fit.held_out_nmse ||
      block_t(lag.fit, best.fit) < kSignificant)
    return std::nullopt;
  return trial_of(best, without);
}

RigMode mode_deviation(const std::vector<RigSeries>& records, const RigTrialBase& base,
                       const RigTrial& trial) {
  const bool attached = !trial.columns.empty();
  const auto fit_of = [&](const RigMode& m) {
    return attached ? fit_attached(records, base, m) : fit_behind(records, base, m);
  };
  const RigFit middle = fit_of(trial.mode);
  const auto deviation = [&](const RigMode& low_mode, const RigMode& high_mode, double step) {
    return deviation_of(fit_of(low_mode), middle, fit_of(high_mode), step);
  };
  const double d_hz = kStep * trial.mode.hz;
  const double d_damping = 0.2 * trial.mode.damping;
  RigMode lower = trial.mode;
  RigMode higher = trial.mode;
  lower.hz -= d_hz;
  higher.hz += d_hz;
  RigMode weaker = trial.mode;
  RigMode stronger = trial.mode;
  weaker.damping -= d_damping;
  stronger.damping += d_damping;
  return {deviation(lower, higher, d_hz), deviation(weaker, stronger, d_damping)};
}

}  // namespace dampline::app

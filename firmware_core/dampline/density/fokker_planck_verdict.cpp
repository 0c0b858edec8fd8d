// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "dampline/density/dependence.hpp"
#include "dampline/density/fokker_planck_solver.hpp"

namespace dampline {
namespace {

// Limits of the verdicts. Simulated white input and track lie far on either side of the second
// group: 0.2...0.8 dB against 5...6 dB.
constexpr double kMinVelocityMps = 0.5e-3;
constexpr double kMinChangeMps2 = 1.0e-3;
constexpr double kMinTimeS = 30.0;
constexpr double kMinSegments = 2.0;
constexpr double kMaxOutside = 0.02;
constexpr double kMaxColourDb = 2.5;
constexpr double kMaxDependence = 0.2;
constexpr double kMaxChange = 0.3;     // of ln power, beside ...
constexpr double kChanceSigmas = 4.0;  // ... as many deviations of chance
constexpr std::size_t kMinGroups = 8;

/// Scatter of the spectrum's lines about their mean, dB.
double colour_db(const InputSpectrum::Sums& sums) noexcept {
  constexpr double kSmallest = 1e-30;
  std::array<double, InputSpectrum::kLines> db{};
  for (std::size_t k = 0; k < db.size(); ++k) {
    db[k] = 10.0 * std::log10(std::max(sums.power[k], kSmallest));
  }
  double sum = 0.0;
  for (const double line : db) sum += line;
  const double mean = sum / static_cast<double>(db.size());
  double squares = 0.0;
  for (const double line : db) squares += (line - mean) * (line - mean);
  return std::sqrt(squares / static_cast<double>(db.size()));
}

double std_of(double squares, double sum, double count) noexcept {
  if (!(count > 0.0)) return 0.0;
  return std::sqrt(std::max(squares / count - (sum / count) * (sum / count), 0.0));
}

}  // namespace

TrustVerdict FokkerPlanckSolver::support() const noexcept {
  const FokkerPlanck::Scalars& s = data_.scalars_;
  TrustVerdict verdict;
  verdict.require_at_least(Reason::kNoMotion, data_.velocity_rms_mps(), kMinVelocityMps);
  verdict.require_at_least(
      Reason::kConstantChannel,
      std::min(std_of(s.frame2, s.frame, s.weight), std_of(s.input2, s.input, s.weight)),
      kMinChangeMps2);
  std::size_t groups = 0;
  for (const auto& group : data_.groups_) groups += group.all.count() > 0.0 ? 1U : 0U;
  const double samples = s.weight > 0.0 ? s.weight * s.weight / s.weight_squares : 0.0;
  const double time_s = groups < kMinGroups ? 0.0 : samples / data_.config_.sample_rate_hz;
  verdict.require_at_least(Reason::kShortRecord, time_s, kMinTimeS);
  return verdict;
}

void FokkerPlanckSolver::require_segments(std::size_t segments, TrustVerdict& verdict) noexcept {
  verdict.require_at_least(Reason::kNarrowMotion, static_cast<double>(segments), kMinSegments);
}

void FokkerPlanckSolver::require_range(TrustVerdict& verdict) const noexcept {
  const double outside =
      std::max(data_.velocities_.share_outside(), data_.deflections_.share_outside());
  verdict.require_at_most(Reason::kRangeClips, outside, kMaxOutside);
}

void FokkerPlanckSolver::require_white(TrustVerdict& verdict) const noexcept {
  verdict.require_at_most(Reason::kColouredInput, colour_db(total_.input), kMaxColourDb);
}

void FokkerPlanckSolver::require_stationary(TrustVerdict& verdict) const noexcept {
  const BlockPowers::Change change = data_.powers_.change();
  if (!change.known) return;
  verdict.require_at_most(Reason::kNonStationary, change.size,
                          kMaxChange + kChanceSigmas * change.chance);
}

void FokkerPlanckSolver::require_independent(TrustVerdict& verdict) const noexcept {
  const Dependence found = dependence(data_.joint_, data_.scalars_.crossings / weight_);
  if (found.known) verdict.require_at_most(Reason::kDependence, found.size, kMaxDependence);
}

}  // namespace dampline

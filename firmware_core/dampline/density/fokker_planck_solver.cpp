// SPDX-License-Identifier: MIT
#include "dampline/density/fokker_planck_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dampline/density/joint_histogram.hpp"

namespace dampline {
namespace {

constexpr double kBandwidthShare = 0.25;  // of the rms velocity
constexpr double kExcludedBandwidths = 3.0;

double sum_of(const std::array<double, InputSpectrum::kLines>& lines) noexcept {
  double sum = 0.0;
  for (const double line : lines) sum += line;
  return sum;
}

double level_of(const InputSpectrum::Sums& sums) noexcept {
  if (!(sums.weight > 0.0)) return 0.0;
  return sum_of(sums.power) / (sums.weight * static_cast<double>(InputSpectrum::kLines));
}

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
// Trucks with dry friction 0.05 to 0.10, whole cars whose frames pitch 0.16 to 0.42.
constexpr double kMaxSag = 0.13;
constexpr double kFewestFast = 300.0;  // samples a side
constexpr std::size_t kSlowBin = 3;    // 5.5 to 8 mm/s
constexpr std::size_t kFastBin = 6;    // 14.5 mm/s and more

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

FokkerPlanckSolver::FokkerPlanckSolver(const FokkerPlanck& data, double mass_kg,
                                       double stiffness_npm) noexcept
    : data_{data},
      half_mass_kg_{0.5 * mass_kg},
      beta_{2.0 * stiffness_npm / mass_kg},
      weight_{data.weight_.value()},
      total_{without(kNone)},
      segments_{supported_segments(total_.all)},
      away_segments_{supported_segments(total_.away)},
      modulation_{data.modulation_.shape()} {
  deflections_ = deflection_integrals(data.deflections_, modulation_);
  bandwidth_mps_ =
      std::max(kBandwidthShare * data.velocity_rms_mps(), 2.0 * data.velocities_.axis().width());
  reach_mps_ = speed_quantile(data.velocities_, 0.99);
}

FokkerPlanck::Group FokkerPlanckSolver::without(std::size_t left_out) const noexcept {
  FokkerPlanck::Group sum;
  for (std::size_t g = 0; g < kSampleGroups; ++g) {
    if (g == left_out) continue;
    const FokkerPlanck::Group& group = data_.groups_[g];
    sum.all.add(group.all, 1.0 / weight_);
    sum.away.add(group.away, 1.0 / weight_);
    sum.input.add(group.input, 1.0 / weight_);
  }
  return sum;
}

PaperForm FokkerPlanckSolver::paper(double bandwidth_mps, double excluded_mps, double reach_mps,
                                    std::size_t left_out, std::size_t segments) const noexcept {
  return fit_paper_form(data_.velocities_, deflections_,
                        {.beta = beta_,
                         .input_level = level_of(without(left_out).input),
                         .modulation = modulation_,
                         .bandwidth_mps = bandwidth_mps,
                         .excluded_mps = excluded_mps,
                         .reach_mps = reach_mps,
                         .segments = segments,
                         .left_out_group = left_out});
}

FokkerPlanckSolution FokkerPlanckSolver::solve_paper(std::size_t left_out) const noexcept {
  const PaperForm form =
      paper(bandwidth_mps_, kExcludedBandwidths * bandwidth_mps_, reach_mps_, left_out);
  FokkerPlanckSolution out{.ok = form.ok, .level = form.level_mps2()};
  const double constant = data_.config_.deflection_is_absolute ? 0.0 : form.offset();
  std::size_t point = 0;
  for (std::size_t i = kPaperSegments; i > 0; --i) {
    out.alpha[point++] = form.segments[0][i - 1].alpha_mps2 - constant;
  }
  out.alpha[point++] = form.offset_mps2[0] - constant;
  out.alpha[point++] = form.offset_mps2[1] - constant;
  for (std::size_t i = 0; i < kPaperSegments; ++i) {
    out.alpha[point++] = form.segments[1][i].alpha_mps2 - constant;
  }
  return out;
}

FokkerPlanckSolution FokkerPlanckSolver::from_fit(const DriftFit& fit) const noexcept {
  FokkerPlanckSolution out{.ok = fit.ok, .level = fit.level_mps2};
  const double constant = data_.config_.deflection_is_absolute ? 0.0 : fit.offset_mps2;
  std::size_t point = 0;
  for (std::size_t i = fit.segments + 1; i > 0; --i) {
    out.alpha[point++] = fit.alpha_mps2[0][i - 1] - constant;
  }
  for (std::size_t i = 0; i <= fit.segments; ++i) {
    out.alpha[point++] = fit.alpha_mps2[1][i] - constant;
  }
  return out;
}

FokkerPlanckSolution FokkerPlanckSolver::solve_weak(std::size_t left_out) const noexcept {
  const FokkerPlanck::Group sums = without(left_out);
  return from_fit(fit_weak_form(sums.all, data_.bins_, beta_, level_of(sums.input),
                                data_.config_.sample_rate_hz, segments_));
}

FokkerPlanckSolution FokkerPlanckSolver::solve_known(std::size_t left_out) const noexcept {
  return from_fit(fit_known_input(without(left_out).away, data_.bins_, beta_, away_segments_));
}

/// Standard deviations of `size` numbers that `value(g, out)` computes without group g: the
/// jackknife over the groups that hold samples. Groups are of every 16th block, so nearly
/// independent and nearly of one size.
template <class F>
void FokkerPlanckSolver::jackknife(std::size_t size, F&& value, double* std) const noexcept {
  std::array<double, MethodResult::kMaxPoints + 1> x{};
  std::array<double, MethodResult::kMaxPoints + 1> sum{};
  std::array<double, MethodResult::kMaxPoints + 1> squares{};
  std::array<double, MethodResult::kMaxPoints + 1> first{};
  double groups = 0.0;
  for (std::size_t g = 0; g < kSampleGroups; ++g) {
    if (!(data_.groups_[g].all.count() > 0.0)) continue;
    value(g, x.data());
    if (groups == 0.0) first = x;
    groups += 1.0;
    for (std::size_t i = 0; i < size; ++i) {
      const double away = x[i] - first[i];
      sum[i] += away;
      squares[i] += away * away;
    }
  }
  for (std::size_t i = 0; i < size; ++i) {
    const double scatter = std::max(squares[i] - sum[i] * sum[i] / std::max(groups, 1.0), 0.0);
    std[i] = std::sqrt(scatter * (groups - 1.0) / std::max(groups, 1.0));
  }
}

Estimate FokkerPlanckSolver::input_level() const noexcept {
  Estimate out{.value = level_of(total_.input)};
  jackknife(
      1, [this](std::size_t g, double* x) { *x = level_of(without(g).input); }, &out.std);
  return out;
}

/// Numbers, if the record carries any, and whether they can be trusted.
void FokkerPlanckSolver::complete(Solve solve, MethodResult& result) const noexcept {
  TrustVerdict& verdict = result.verdict;
  constexpr std::array kNoNumber{Reason::kNoMotion, Reason::kConstantChannel, Reason::kShortRecord,
                                 Reason::kNarrowMotion, Reason::kRangeClips};
  verdict.has_number = std::none_of(kNoNumber.begin(), kNoNumber.end(),
                                    [&](Reason reason) { return verdict.violates(reason); });
  if (!verdict.has_number) return;
  const FokkerPlanckSolution all = (this->*solve)(kNone);
  std::array<double, MethodResult::kMaxPoints + 1> std{};
  bool ok = all.ok;
  jackknife(
      result.points + 1,
      [&](std::size_t g, double* x) {
        const FokkerPlanckSolution part = (this->*solve)(g);
        ok = ok && part.ok;
        for (std::size_t i = 0; i < result.points; ++i) x[i] = part.alpha[i];
        x[result.points] = part.level;
      },
      std.data());
  verdict.require_at_most(Reason::kNotSolvable, ok ? 0.0 : 1.0, 0.5);
  verdict.has_number = ok;
  if (!ok) return;
  for (std::size_t i = 0; i < result.points; ++i) {
    result.curve[i].force_n = half_mass_kg_ * all.alpha[i];
    result.curve[i].std_n = half_mass_kg_ * std[i];
  }
  result.level_n = {.value = half_mass_kg_ * all.level, .std = half_mass_kg_ * std[result.points]};
  Reason reason{};
  verdict.trusted = !verdict.first_violation(reason);
}

FokkerPlanckEstimates FokkerPlanckSolver::estimates() const noexcept {
  FokkerPlanckEstimates out;
  out.input_level = input_level();
  const TrustVerdict common = support();

  out.paper.verdict = common;
  require_range(out.paper.verdict);
  require_white(out.paper.verdict);
  require_independent(out.paper.verdict);
  require_stationary(out.paper.verdict);
  place_paper_points(out.paper);
  complete(&FokkerPlanckSolver::solve_paper, out.paper);

  out.weak.verdict = common;
  require_segments(segments_, out.weak.verdict);
  require_white(out.weak.verdict);
  require_stationary(out.weak.verdict);
  place_points(total_.all, out.weak);
  complete(&FokkerPlanckSolver::solve_weak, out.weak);

  out.known_input.verdict = common;
  require_segments(away_segments_, out.known_input.verdict);
  require_level(out.known_input.verdict);
  place_points(total_.away, out.known_input);
  complete(&FokkerPlanckSolver::solve_known, out.known_input);
  return out;
}

FokkerPlanckEstimates FokkerPlanck::estimates(double mass_kg, double stiffness_npm) const noexcept {
  return FokkerPlanckSolver{*this, mass_kg, stiffness_npm}.estimates();
}

PaperForm FokkerPlanck::paper_form(double mass_kg, double stiffness_npm, double bandwidth_mps,
                                   double excluded_mps, double reach_mps,
                                   std::size_t segments) const noexcept {
  return FokkerPlanckSolver{*this, mass_kg, stiffness_npm}.paper(
      bandwidth_mps, excluded_mps, reach_mps, kSampleGroups, segments);
}

/// Velocities of the broken line's nodes and their hats' shares of the samples.
void FokkerPlanckSolver::place_points(const DriftSums& sums, MethodResult& result) const noexcept {
  const std::size_t segments = supported_segments(sums);
  const auto& nodes = data_.config_.curve_nodes_mps;
  result.points = 2 * (segments + 1);
  for (std::size_t s = 0; s < 2; ++s) {
    std::array<double, kCurveSegments + 2> held{};
    for (std::size_t b = 0; b < DriftBins::kPerSide; ++b) {
      const DriftMoments& m = sums.sides[s][b];
      const std::size_t left = std::min(b > 0 ? b - 1 : 0, segments);
      const double right_share = b == 0 ? 0.5 * m.u : (b == 1 ? 0.5 * (m.n + m.u) : m.u);
      const double right = b > segments ? m.n : std::min(right_share, m.n);
      held[std::min(left + 1, segments)] += right;
      held[left] += m.n - right;
    }
    for (std::size_t i = 0; i <= segments; ++i) {
      CurvePoint& point = result.curve[s == 1 ? segments + 1 + i : segments - i];
      point.velocity_mps = (s == 1 ? 1.0 : -1.0) * (i > 0 ? nodes[i - 1] : 0.0);
      point.samples = static_cast<std::uint64_t>(std::max(held[i], 0.0));
    }
  }
}

void FokkerPlanckSolver::place_paper_points(MethodResult& result) const noexcept {
  result.points = 2 * (kPaperSegments + 1);
  const double length = reach_mps_ / static_cast<double>(kPaperSegments);
  for (std::size_t i = 0; i <= kPaperSegments; ++i) {
    const double speed = static_cast<double>(i) * length;
    result.curve[kPaperSegments - i].velocity_mps = -speed;
    result.curve[kPaperSegments + 1 + i].velocity_mps = speed;
  }
  const auto& velocities = data_.velocities_;
  for (std::size_t b = 0; b < kVelocityBins; ++b) {
    const double v = velocities.axis().centre(b);
    const auto node =
        std::min(static_cast<std::size_t>(std::lround(std::abs(v) / length)), kPaperSegments);
    CurvePoint& point = result.curve[v > 0.0 ? kPaperSegments + 1 + node : kPaperSegments - node];
    point.samples += static_cast<std::uint64_t>(velocities.mass(b));
  }
}

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

/// The force of bins of velocity, without what is the same on both sides; 0 with too few samples.
double FokkerPlanckSolver::force_of(std::size_t first, std::size_t end) const noexcept {
  double force = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    DriftMoments sum;
    for (std::size_t b = first; b < end; ++b) sum.add(total_.away.sides[s][b]);
    if (sum.n < kFewestFast) return 0.0;
    force += (s == 0 ? 1.0 : -1.0) * (2.0 * sum.a + beta_ * sum.y) / sum.n;
  }
  return force;
}

/// A level is what it gives: where dampers of a pitching frame slide against each other, which they
/// do in slow motion, there is less of it.
void FokkerPlanckSolver::require_level(TrustVerdict& verdict) const noexcept {
  const double fast = force_of(kFastBin, DriftBins::kPerSide);
  if (!(fast > 0.0)) return;
  verdict.require_at_most(Reason::kBentCurve, 1.0 - force_of(kSlowBin, kSlowBin + 1) / fast,
                          kMaxSag);
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

// SPDX-License-Identifier: MIT
#include "dampline/density/fokker_planck_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>

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
                                    std::size_t left_out) const noexcept {
  return fit_paper_form(data_.velocities_, deflections_,
                        {.beta = beta_,
                         .input_level = level_of(without(left_out).input),
                         .modulation = modulation_,
                         .bandwidth_mps = bandwidth_mps,
                         .excluded_mps = excluded_mps,
                         .reach_mps = reach_mps,
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
  for (const PaperSegment& segment : form.segments[1]) {
    out.alpha[point++] = segment.alpha_mps2 - constant;
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
  place_points(total_.away, out.known_input);
  complete(&FokkerPlanckSolver::solve_known, out.known_input);
  return out;
}

FokkerPlanckEstimates FokkerPlanck::estimates(double mass_kg, double stiffness_npm) const noexcept {
  return FokkerPlanckSolver{*this, mass_kg, stiffness_npm}.estimates();
}

PaperForm FokkerPlanck::paper_form(double mass_kg, double stiffness_npm, double bandwidth_mps,
                                   double excluded_mps, double reach_mps) const noexcept {
  return FokkerPlanckSolver{*this, mass_kg, stiffness_npm}.paper(bandwidth_mps, excluded_mps,
                                                                 reach_mps, kSampleGroups);
}

}  // namespace dampline

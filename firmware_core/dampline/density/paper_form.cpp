// SPDX-License-Identifier: MIT
#include "dampline/density/paper_form.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dampline/numeric/cholesky.hpp"

namespace dampline {
namespace {

constexpr int kMostUnknowns = static_cast<int>(kMostPaperSegments) + 1;
constexpr double kReachShare = 0.99;
using System = Cholesky<kMostUnknowns>;

/// p2 and its derivatives at the bins' centres.
struct SmoothDensity {
  std::array<double, kVelocityBins> p{}, dp{}, ddp{};
};

SmoothDensity smooth(const VelocityHistogram& velocities, const PaperFormConfig& config) noexcept {
  const double width = velocities.axis().width();
  const double h = std::max(config.bandwidth_mps, width);
  const auto reach = static_cast<int>(std::min(5.0 * h / width, double{kVelocityBins}));
  std::array<double, kVelocityBins> share{};
  double total = 0.0;
  for (std::size_t b = 0; b < kVelocityBins; ++b) {
    share[b] = velocities.mass(b);
    if (config.left_out_group < kSampleGroups) {
      share[b] -= velocities.mass(b, config.left_out_group);
    }
    total += share[b];
  }
  SmoothDensity out;
  if (!(total > 0.0)) return out;
  for (int d = -reach; d <= reach; ++d) {  // distance from the mass to the place, in bins
    const double u = d * width / h;
    const double kernel = std::exp(-0.5 * u * u) / (std::sqrt(2.0 * std::numbers::pi) * h * total);
    for (int b = std::max(0, d); b < std::min(int{kVelocityBins}, int{kVelocityBins} + d); ++b) {
      const auto at = static_cast<std::size_t>(b);
      const double mass = kernel * share[static_cast<std::size_t>(b - d)];
      out.p[at] += mass;
      out.dp[at] -= mass * u / h;
      out.ddp[at] += mass * (u * u - 1.0) / (h * h);
    }
  }
  return out;
}

/// One side of zero; speeds are |v|, and alpha and p2' are taken outwards.
struct Side {
  double length_mps;  // of a segment
  double excluded_mps;
  int first;     // segments before it lie in the excluded region: slope 0
  int segments;  // the unknown after their slopes is the offset
};

/// d/dv of R_i p2 for ramp i or, after the last, the offset, of which the paper drops the jump at
/// zero.
double column(int i, const Side& side, double speed, double p, double dp) noexcept {
  if (i == side.segments) return dp;
  const double start = i * side.length_mps;
  if (speed <= start) return 0.0;
  const double rise = speed - start;
  return rise < side.length_mps ? p + rise * dp : side.length_mps * dp;
}

double alpha_at(const PaperForm& form, std::size_t s, double speed_mps) noexcept {
  double alpha = form.offset_mps2[s];
  for (const PaperSegment& segment : form.segments[s]) {
    const double part = std::min(speed_mps, segment.to_mps) - segment.from_mps;
    if (part <= 0.0) break;
    alpha += segment.slope_ps * part;
  }
  return alpha;
}

/// Integrals over y, each over that of p1^2.
struct Ratios {
  double psi2, psi4, y, p1_dp1;
};

void add_integrals(const Ratios& r, double v, double p, double dp, double ddp, double width,
                   PaperIntegrals& out) noexcept {
  out.aa += 0.25 * r.psi4 * ddp * ddp * width;
  out.ab += 0.5 * r.psi2 * ddp * dp * width;
  out.ac += 0.5 * r.psi2 * ddp * p * width;
  out.bb += dp * dp * width;
  out.bc += dp * p * width;
  out.cc += p * p * width;
  out.bd -= r.p1_dp1 * v * p * dp * width;
  out.cd -= r.p1_dp1 * v * p * p * width;
  out.br += r.y * dp * dp * width;
  out.cr += r.y * p * dp * width;
}

class SideFit {
 public:
  SideFit(const SmoothDensity& density, const VelocityHistogram::Axis& axis, const Ratios& ratios,
          double beta, std::size_t s, const Side& side) noexcept
      : density_{density}, axis_{axis}, ratios_{ratios}, beta_{beta}, s_{s}, side_{side} {}

  [[nodiscard]] bool solve(PaperForm& out) noexcept {
    accumulate(out.integrals);
    const int size = side_.segments + 1 - side_.first;
    System cholesky;
    if (!cholesky.factor(matrix_, size)) return false;
    cholesky.solve(right_);
    write(out);
    return true;
  }

 private:
  /// Place of a bin's centre on this side; not positive: on the other.
  [[nodiscard]] double speed(std::size_t bin) const noexcept {
    return s_ == 1 ? axis_.centre(bin) : -axis_.centre(bin);
  }

  // Outwards from zero, v = speed for both sides: alpha and p2' change their sign on the negative
  // side, p2, p2'' and y p1^2's factor as well as v p1' keep the equation's form.
  void accumulate(PaperIntegrals& integrals) noexcept {
    const double sign = s_ == 1 ? 1.0 : -1.0;
    for (std::size_t b = 0; b < kVelocityBins; ++b) {
      const double v = speed(b);
      if (v <= side_.excluded_mps) continue;
      const double p = density_.p[b];
      const double dp = sign * density_.dp[b];
      const double ddp = density_.ddp[b];
      add_integrals(ratios_, axis_.centre(b), p, density_.dp[b], ddp, axis_.width(), integrals);
      const double target =
          -0.5 * ratios_.psi2 * ddp - beta_ * ratios_.y * sign * dp + ratios_.p1_dp1 * sign * v * p;
      const int size = side_.segments + 1 - side_.first;
      std::array<double, kMostUnknowns> g{};
      for (int i = 0; i < size; ++i) {
        g[static_cast<std::size_t>(i)] = column(side_.first + i, side_, v, p, dp);
      }
      for (int i = 0; i < size; ++i) {
        right_[i] += g[static_cast<std::size_t>(i)] * target;
        for (int j = 0; j < size; ++j) {
          matrix_(i, j) += g[static_cast<std::size_t>(i)] * g[static_cast<std::size_t>(j)];
        }
      }
    }
  }

  void write(PaperForm& out) const noexcept {
    const double sign = s_ == 1 ? 1.0 : -1.0;
    out.offset_mps2[s_] = sign * right_[side_.segments - side_.first];
    double alpha = out.offset_mps2[s_];
    for (int i = 0; i < side_.segments; ++i) {
      PaperSegment& segment = out.segments[s_][static_cast<std::size_t>(i)];
      segment.from_mps = i * side_.length_mps;
      segment.to_mps = (i + 1) * side_.length_mps;
      segment.slope_ps = i < side_.first ? 0.0 : sign * right_[i - side_.first];
      alpha += segment.slope_ps * side_.length_mps;
      segment.alpha_mps2 = alpha;
    }
    double weight = 0.0;
    for (std::size_t b = 0; b < kVelocityBins; ++b) {
      const double v = speed(b);
      if (v <= side_.excluded_mps) continue;
      const double squared = density_.p[b] * density_.p[b];
      weight += squared;
      out.mean_mps2[s_] += squared * alpha_at(out, s_, v);
    }
    if (weight > 0.0) out.mean_mps2[s_] /= weight;
  }

  const SmoothDensity& density_;
  const VelocityHistogram::Axis& axis_;
  Ratios ratios_;
  double beta_;
  std::size_t s_;
  Side side_;
  System::Matrix matrix_ = System::Matrix::Zero();
  System::Vector right_ = System::Vector::Zero();
};

}  // namespace

DeflectionIntegrals deflection_integrals(const DeflectionHistogram& deflections,
                                         const Modulation::Polynomial& modulation) noexcept {
  DeflectionIntegrals out;
  const double width = deflections.axis().width();
  for (std::size_t b = 0; b < kDeflectionBins; ++b) {
    const double p = deflections.density(b);
    const double y = deflections.axis().centre(b);
    const double psi2 = Modulation::at(modulation, y);
    const double before = b > 0 ? deflections.density(b - 1) : 0.0;
    const double after = b + 1 < kDeflectionBins ? deflections.density(b + 1) : 0.0;
    out.p1_p1 += p * p * width;
    out.psi2_p1_p1 += psi2 * p * p * width;
    out.psi4_p1_p1 += psi2 * psi2 * p * p * width;
    out.y_p1_p1 += y * p * p * width;
    out.p1_dp1 += 0.5 * p * (after - before);
  }
  return out;
}

double speed_quantile(const VelocityHistogram& velocities, double share) noexcept {
  const auto& axis = velocities.axis();
  const auto largest = static_cast<int>(axis.high() / axis.width());
  for (int widths = 1; widths < largest; ++widths) {
    const double speed = widths * axis.width();
    double inside = 0.0;
    for (std::size_t b = 0; b < kVelocityBins; ++b) {
      if (std::abs(axis.centre(b)) < speed) inside += velocities.share(b);
    }
    if (inside >= share) return speed;
  }
  return axis.high();
}

PaperForm fit_paper_form(const VelocityHistogram& velocities,
                         const DeflectionIntegrals& deflections,
                         const PaperFormConfig& config) noexcept {
  PaperForm out;
  if (!(deflections.p1_p1 > 0.0)) return out;
  const std::size_t segments = std::clamp(config.segments, std::size_t{1}, kMostPaperSegments);
  out.used = segments;
  const double reach =
      config.reach_mps > 0.0 ? config.reach_mps : speed_quantile(velocities, kReachShare);
  const double length = reach / static_cast<double>(segments);
  // Whole segments are left out: what is left of one that is cut would be free to follow 1 / p2,
  // which (alpha p2)' does not see.
  const auto first = static_cast<int>(std::ceil(config.excluded_mps / length - 1e-9));
  if (first >= static_cast<int>(segments)) return out;
  const Side side{.length_mps = length,
                  .excluded_mps = first * length,
                  .first = first,
                  .segments = static_cast<int>(segments)};
  const double level = config.input_level;
  const Ratios ratios{.psi2 = level * deflections.psi2_p1_p1 / deflections.p1_p1,
                      .psi4 = level * level * deflections.psi4_p1_p1 / deflections.p1_p1,
                      .y = deflections.y_p1_p1 / deflections.p1_p1,
                      .p1_dp1 = deflections.p1_dp1 / deflections.p1_p1};
  const SmoothDensity density = smooth(velocities, config);
  const auto fit = [&](std::size_t s) {
    return SideFit{density, velocities.axis(), ratios, config.beta, s, side}.solve(out);
  };
  out.ok = fit(0) && fit(1);
  return out;
}

}  // namespace dampline

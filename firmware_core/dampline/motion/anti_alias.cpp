// SPDX-License-Identifier: MIT
#include "dampline/motion/anti_alias.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "dampline/numeric/cholesky.hpp"

namespace dampline {
namespace {

constexpr double kPi = 3.141592653589793238;
constexpr int kGrid = 512;
constexpr double kOutOfBandWeight = 0.02;
constexpr double kExactWeight = 1e7;
constexpr double kHighestLifted = 0.4;  // cycles per sample

/// Part of a Butterworth filter's loss, and a raised cosine down to zero above the edge, so
/// that noise is not amplified.
double lift(double relative, int order, double share, double beyond) noexcept {
  const double loss = std::sqrt(butterworth_loss(relative, order));
  return std::pow(loss, share) * (0.5 + 0.5 * std::cos(kPi * beyond));
}

}  // namespace

double VelocityLift::share_of_loss(const AntiAliasConfig& filter) noexcept {
  constexpr double kThinned = 0.75;
  constexpr double kFolded = 0.60;
  constexpr double kHighCornerHz = 100.0;
  constexpr double kLowCornerHz = 76.0;
  const double low =
      std::clamp((kHighCornerHz - filter.corner_hz) / (kHighCornerHz - kLowCornerHz), 0.0, 1.0);
  return std::lerp(filter.thinned ? kThinned : kFolded, 1.0, low);
}

VelocityLift::VelocityLift(const AntiAliasConfig& config, double sample_rate_hz) noexcept {
  taps_[kHalf] = 1.0;
  if (!(config.corner_hz > 0.0)) return;
  const double corner = config.corner_hz / sample_rate_hz;
  const double edge = std::fmin(corner, kHighestLifted);
  const double share = share_of_loss(config);
  // Least squares over the cosines of a symmetric filter, exact at zero frequency.
  using Basis = Eigen::Matrix<double, kHalf + 1, 1>;
  Eigen::Matrix<double, kHalf + 1, kHalf + 1> normal;
  normal.setConstant(kExactWeight);
  Basis right = Basis::Constant(kExactWeight);
  for (int i = 0; i < kGrid; ++i) {
    const double f = (i + 0.5) * 0.5 / kGrid;
    const double beyond = std::fmax(0.0, (f - edge) / (0.5 - edge));
    const double weight = beyond > 0.0 ? kOutOfBandWeight : 1.0;
    Basis cosine;
    for (int k = 0; k <= kHalf; ++k) cosine[k] = std::cos(2.0 * kPi * f * k);
    normal += weight * cosine.lazyProduct(cosine.transpose());
    right += weight * lift(f / corner, config.order, share, beyond) * cosine;
  }
  const Basis fit = solve_cholesky<kHalf + 1>(normal, right);
  taps_[kHalf] = fit[0];
  for (int k = 1; k <= kHalf; ++k) {
    taps_[static_cast<std::size_t>(kHalf + k)] = taps_[static_cast<std::size_t>(kHalf - k)] =
        0.5 * fit[k];
  }
}

}  // namespace dampline

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

/// Phase of a Butterworth filter beside that of its delay, rad, from its poles.
double phase_beside_delay(double relative, int order) noexcept {
  double phase = relative / std::sin(kPi / (2.0 * order));
  for (int k = 0; k < order; ++k) {
    const double angle = kPi * (2.0 * k + 1.0) / (2.0 * order);
    const double real = std::sin(angle);
    const double imaginary = std::cos(angle);
    phase -= std::atan2(relative - imaginary, real) + std::atan2(imaginary, real);
  }
  return phase;
}

/// What is undone of the phase that the fast parts get by a filter below the usual one.
double phase_undone(double hz, const AntiAliasConfig& filter) noexcept {
  constexpr double kShare = 0.8;
  constexpr AntiAliasConfig kUsual{};
  if (!(filter.corner_hz < kUsual.corner_hz)) return 0.0;
  return kShare * (phase_beside_delay(hz / kUsual.corner_hz, kUsual.order) -
                   phase_beside_delay(hz / filter.corner_hz, filter.order));
}

}  // namespace

double VelocityLift::share_of_loss(const AntiAliasConfig& filter) noexcept {
  constexpr double kThinned = 0.75;
  constexpr double kFolded = 0.60;
  constexpr double kHighCornerHz = 100.0;
  constexpr double kLowCornerHz = 76.0;
  constexpr double kBeyond = 0.05;
  const double low =
      std::max((kHighCornerHz - filter.corner_hz) / (kHighCornerHz - kLowCornerHz), 0.0);
  return std::lerp(filter.thinned ? kThinned : kFolded, 1.0, std::min(low, 1.0)) +
         kBeyond * std::max(low - 1.0, 0.0);
}

VelocityLift::VelocityLift(const AntiAliasConfig& config, double sample_rate_hz) noexcept {
  taps_[kHalf] = 1.0;
  if (!(config.corner_hz > 0.0)) return;
  const double corner = config.corner_hz / sample_rate_hz;
  const double edge = std::fmin(corner, kHighestLifted);
  const double share = share_of_loss(config);
  // Least squares over cosines, exact at zero frequency, and for the phase over sines.
  using Basis = Eigen::Matrix<double, kHalf + 1, 1>;
  using Normal = Eigen::Matrix<double, kHalf + 1, kHalf + 1>;
  Normal even = Normal::Constant(kExactWeight);
  Normal odd = Normal::Zero();
  odd(0, 0) = 1.0;  // a sine of nothing
  Basis right = Basis::Constant(kExactWeight);
  Basis right_odd = Basis::Zero();
  for (int i = 0; i < kGrid; ++i) {
    const double f = (i + 0.5) * 0.5 / kGrid;
    const double beyond = std::fmax(0.0, (f - edge) / (0.5 - edge));
    const double weight = beyond > 0.0 ? kOutOfBandWeight : 1.0;
    Basis cosine, sine;
    for (int k = 0; k <= kHalf; ++k) {
      cosine[k] = std::cos(2.0 * kPi * f * k);
      sine[k] = std::sin(2.0 * kPi * f * k);
    }
    const double wanted = lift(f / corner, config.order, share, beyond);
    const double phase = phase_undone(f * sample_rate_hz, config);
    even += weight * cosine.lazyProduct(cosine.transpose());
    right += weight * wanted * std::cos(phase) * cosine;
    odd += weight * sine.lazyProduct(sine.transpose());
    right_odd += weight * wanted * std::sin(phase) * sine;
  }
  const Basis gain = solve_cholesky<kHalf + 1>(even, right);
  const Basis turn = solve_cholesky<kHalf + 1>(odd, right_odd);
  taps_[kHalf] = gain[0];
  for (int k = 1; k <= kHalf; ++k) {
    taps_[static_cast<std::size_t>(kHalf + k)] = 0.5 * (gain[k] - turn[k]);
    taps_[static_cast<std::size_t>(kHalf - k)] = 0.5 * (gain[k] + turn[k]);
  }
}

}  // namespace dampline

// SPDX-License-Identifier: MIT
#include "dampline/motion/frame_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline {
namespace {

constexpr double kFirst = 0.3;  // of the sampling rate: the band that is looked at
constexpr double kLast = 0.493;
constexpr double kHannPower = 0.375;
constexpr double kFewestSegments = 36.0;
constexpr int kIterations = 4;
constexpr double kLeast = 1e-3;  // of the largest power, so that no weight is without bound

}  // namespace

FrameNoise::FrameNoise(double sample_rate_hz, const AntiAliasConfig& anti_alias)
    : rate_hz_{sample_rate_hz},
      first_bin_{static_cast<std::size_t>(std::ceil(kFirst * Fourier512::kSize))},
      last_bin_{static_cast<std::size_t>(
          std::floor((anti_alias.thinned ? kThinnedEdge : kLast) * Fourier512::kSize))} {
  for (std::size_t n = 0; n < window_.size(); ++n) {
    const double turn = static_cast<double>(n) / Fourier512::kSize;
    window_[n] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * turn);
  }
  for (std::size_t k = first_bin_; k <= last_bin_; ++k)
    folded_[k] = leap_power(anti_alias, hz(k), rate_hz_);
}

void FrameNoise::take(const Sample& sample) {
  const double accel = sample.accel_mps2[0];
  if (!std::isfinite(accel) || sample.tick != last_tick_ + 1) count_ = 0;
  last_tick_ = sample.tick;
  if (!std::isfinite(accel)) return;
  held_[count_++] = accel;
  if (count_ < held_.size()) return;
  add_segment();
  count_ = held_.size() / 2;  // segments overlap by half
  std::copy(held_.begin() + static_cast<std::ptrdiff_t>(count_), held_.end(), held_.begin());
}

void FrameNoise::add_segment() {
  double mean = 0.0;
  for (const double x : held_) mean += x / static_cast<double>(held_.size());
  for (std::size_t n = 0; n < held_.size(); ++n) fourier_.set(n, window_[n] * (held_[n] - mean));
  fourier_.start();
  fourier_.advance(Fourier512::kButterflies);
  for (std::size_t k = first_bin_; k <= last_bin_; ++k) power_[k] += std::norm(fourier_[k]);
  segments_ += 1.0;
}

/// A constant and a multiple of the folded shape, by weighted least squares: a power scatters in
/// proportion to its expectation, which the fit before tells.
double FrameNoise::noise_mps2() const {
  if (segments_ < kFewestSegments) return 0.0;
  const double scale = 1.0 / (segments_ * kHannPower * Fourier512::kSize);
  const double largest = *std::max_element(power_.begin(), power_.end());
  std::array<double, kBins> expected = power_;
  double white = 0.0;
  for (int i = 0; i < kIterations; ++i) {
    WhiteAndFolded fit;
    for (std::size_t k = first_bin_; k <= last_bin_; ++k)
      fit.add(1.0 / (expected[k] * expected[k]), folded_[k] / folded_[first_bin_], power_[k]);
    if (!(fit.determinant() > 0.0)) return 0.0;
    white = fit.constant();
    const double folded = fit.multiple();
    for (std::size_t k = first_bin_; k <= last_bin_; ++k)
      expected[k] = std::max(white + folded * folded_[k] / folded_[first_bin_], kLeast * largest);
  }
  return std::sqrt(scale * std::max(white, 0.0));
}

}  // namespace dampline

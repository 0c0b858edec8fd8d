// SPDX-License-Identifier: MIT
#include "dampline/motion/frame_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace dampline {
namespace {

constexpr double kFirst = 0.3;  // of the sampling rate: the band that is looked at
constexpr double kLast = 0.493;
constexpr double kFirstShaken = 0.1;  // where leaps tell the low pass
constexpr double kLowestHz = 25.0;    // of the corners that are tried
constexpr double kHighest = 0.5;      // of the rate
constexpr double kStep = 1.01;
constexpr double kLeastShaken = 1e-6;  // there a low pass takes much
constexpr double kHannPower = 0.375;
constexpr double kFewestSegments = 36.0;
constexpr int kIterations = 4;
constexpr double kLeast = 1e-3;  // of the largest power, so that no weight is without bound

}  // namespace

FrameNoise::FrameNoise(double sample_rate_hz, const AntiAliasConfig& anti_alias)
    : rate_hz_{sample_rate_hz},
      sensor_{anti_alias.of(0)},
      first_shaken_bin_{static_cast<std::size_t>(std::ceil(kFirstShaken * Fourier512::kSize))},
      first_bin_{static_cast<std::size_t>(std::ceil(kFirst * Fourier512::kSize))},
      last_bin_{static_cast<std::size_t>(
          std::floor((anti_alias.thinned ? kThinnedEdge : kLast) * Fourier512::kSize))} {
  for (std::size_t n = 0; n < window_.size(); ++n) {
    const double turn = static_cast<double>(n) / Fourier512::kSize;
    window_[n] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * turn);
  }
  for (std::size_t k = first_bin_; k <= last_bin_; ++k)
    folded_[k] = leap_power(sensor_, hz(k), rate_hz_);
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
  for (std::size_t k = first_shaken_bin_; k <= last_bin_; ++k) power_[k] += std::norm(fourier_[k]);
  segments_ += 1.0;
}

/// By weighted least squares: a power scatters in proportion to its expectation, which the fit
/// before tells.
FrameNoise::LeapFit FrameNoise::fit(const std::array<double, kBins>& folded, std::size_t from,
                                    double least) const {
  const double largest =
      *std::max_element(power_.begin() + static_cast<std::ptrdiff_t>(from), power_.end());
  LeapFit out;
  out.expected = power_;
  for (int i = 0; i < kIterations; ++i) {
    WhiteAndFolded sums;
    for (std::size_t k = from; k <= last_bin_; ++k)
      sums.add(1.0 / (out.expected[k] * out.expected[k]), folded[k] / folded[from], power_[k]);
    if (!(sums.determinant() > 0.0)) return {};
    out.white = sums.constant();
    for (std::size_t k = from; k <= last_bin_; ++k)
      out.expected[k] =
          std::max(out.white + sums.multiple() * folded[k] / folded[from], least * largest);
  }
  return out;
}

double FrameNoise::noise_mps2() const {
  if (segments_ < kFewestSegments) return 0.0;
  const double scale = 1.0 / (segments_ * kHannPower * Fourier512::kSize);
  return std::sqrt(scale * std::max(fit(folded_, first_bin_, kLeast).white, 0.0));
}

/// The most likely, of powers that scatter in proportion to their expectation.
double FrameNoise::corner_hz() const {
  if (segments_ < kFewestSegments) return 0.0;
  double found_hz = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (double hz_tried = kLowestHz; hz_tried < kHighest * rate_hz_; hz_tried *= kStep) {
    const AntiAliasConfig filter{hz_tried, sensor_.order, sensor_.thinned};
    std::array<double, kBins> folded{};
    for (std::size_t k = first_shaken_bin_; k <= last_bin_; ++k)
      folded[k] = leap_power(filter, hz(k), rate_hz_);
    const LeapFit leaps = fit(folded, first_shaken_bin_, kLeastShaken);
    double doubt = 0.0;
    for (std::size_t k = first_shaken_bin_; k <= last_bin_; ++k)
      doubt += std::log(leaps.expected[k]) + power_[k] / leaps.expected[k];
    if (!(doubt < least)) continue;
    least = doubt;
    found_hz = hz_tried;
  }
  return found_hz;
}

}  // namespace dampline

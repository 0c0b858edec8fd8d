// SPDX-License-Identifier: MIT
#include "dampline/motion/reference_low_pass.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "dampline/numeric/cholesky.hpp"

namespace dampline {
namespace {

constexpr double kReferenceHz = 100.0;
constexpr int kReferenceOrder = 4;
constexpr double kHighestSeenHz = 105.0;  // corner of sensors that are near enough
constexpr int kResponseGrid = 512;
constexpr double kDelaySamples = 2.0;
constexpr double kEdge = 0.42;  // cycles per sample
constexpr double kBeyondEdgeWeight = 0.02;
constexpr double kAtZeroWeight = 1e6;

/// Butterworth's response at a frequency relative to the corner, from its poles.
std::complex<double> butterworth(double relative, int order) noexcept {
  std::complex<double> out{1.0, 0.0};
  for (int k = 1; k <= order; ++k) {
    const std::complex<double> pole =
        std::polar(1.0, std::numbers::pi * (2.0 * k + order - 1.0) / (2.0 * order));
    out *= -pole / (std::complex<double>{0.0, relative} - pole);
  }
  return out;
}

}  // namespace

AntiAliasConfig ReferenceLowPass::seen_behind(const AntiAliasConfig& sensors) noexcept {
  AntiAliasConfig lowest = sensors.of(kChannels);
  for (std::size_t c = 0; c < kChannels; ++c)
    lowest.corner_hz = std::min(lowest.corner_hz, sensors.of(c).corner_hz);
  if (!(lowest.corner_hz > kHighestSeenHz)) return lowest;
  return {kReferenceHz, kReferenceOrder, true};
}

ReferenceLowPass::ReferenceLowPass(const AntiAliasConfig& sensors, double sample_rate_hz) noexcept {
  const AntiAliasConfig seen = seen_behind(sensors);
  for (std::size_t s = 0; s < kSignals; ++s)
    is_needed_ = is_needed_ || sensors.of(s).corner_hz != seen.corner_hz;
  for (std::size_t s = 0; is_needed_ && s < kSignals; ++s) {
    const auto taps = taps_between(sensors.of(s), seen, sample_rate_hz);
    for (std::size_t n = 0; n < kTaps; ++n) taps_[n][s] = taps[n];
  }
}

std::array<double, ReferenceLowPass::kTaps> ReferenceLowPass::taps_between(
    const AntiAliasConfig& sensor, const AntiAliasConfig& reference,
    double sample_rate_hz) noexcept {
  using Column = Eigen::Matrix<double, kTaps, 1>;
  // Exact at zero frequency.
  Eigen::Matrix<double, kTaps, kTaps> normal;
  normal.setConstant(kAtZeroWeight);
  Column right = Column::Constant(kAtZeroWeight);
  for (int i = 0; i < kResponseGrid; ++i) {
    const double f = (i + 0.5) * 0.5 / kResponseGrid;
    const double weight = f > kEdge ? kBeyondEdgeWeight : 1.0;
    const double hz = f * sample_rate_hz;
    const std::complex<double> wanted = butterworth(hz / reference.corner_hz, reference.order) /
                                        butterworth(hz / sensor.corner_hz, sensor.order);
    const double turn = 2.0 * std::numbers::pi * f;
    Column cosine;
    for (std::size_t n = 0; n < kTaps; ++n) {
      const double phase = turn * static_cast<double>(n);
      cosine[static_cast<Eigen::Index>(n)] = std::cos(phase);
      right[static_cast<Eigen::Index>(n)] +=
          weight * (wanted * std::polar(1.0, phase - turn * kDelaySamples)).real();
    }
    for (Eigen::Index r = 0; r < normal.rows(); ++r)
      for (Eigen::Index c = 0; c < normal.cols(); ++c)
        normal(r, c) += weight * cosine[std::abs(r - c)];
  }
  const Column fit = solve_cholesky<static_cast<int>(kTaps)>(normal, right);
  std::array<double, kTaps> out{};
  std::copy(fit.begin(), fit.end(), out.begin());
  return out;
}

const Sample& ReferenceLowPass::filtered(const Sample& sample) noexcept {
  Signals now{};
  std::copy(sample.accel_mps2.begin(), sample.accel_mps2.end(), now.begin());
  std::copy(sample.extra_mps2.begin(), sample.extra_mps2.end(), now.begin() + kChannels);
  const bool usable = !sample.spoilt && std::all_of(now.begin(), now.end(),
                                                    [](double a) { return std::isfinite(a); });
  if (!usable || sample.tick != last_tick_ + 1) any_ = false;
  last_tick_ = sample.tick;
  if (!usable) return sample;
  if (!any_) held_.fill(now);
  any_ = true;
  newest_ = (newest_ + 1) % kTaps;
  held_[newest_] = now;
  Signals sums{};
  for (std::size_t n = 0; n < kTaps; ++n)
    for (std::size_t s = 0; s < kSignals; ++s)
      sums[s] += taps_[n][s] * held_[(newest_ + kTaps - n) % kTaps][s];
  out_ = sample;
  std::copy_n(sums.begin(), kChannels, out_.accel_mps2.begin());
  for (std::size_t e = 0; e < kExtras; ++e)
    out_.extra_mps2[e] = static_cast<float>(sums[kChannels + e]);
  return out_;
}

}  // namespace dampline

// SPDX-License-Identifier: MIT
#include "app/explain/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline::app {
namespace {

double sinc(double x) {
  const double turn = std::numbers::pi * x;
  return std::abs(turn) < 1e-9 ? 1.0 : std::sin(turn) / turn;
}

/// Blackman's weight, 1 at 0, 0 from +-1 on.
double weight(double u) {
  if (std::abs(u) >= 1.0) return 0.0;
  const double turn = std::numbers::pi * u;
  return 0.42 + 0.5 * std::cos(turn) + 0.08 * std::cos(2.0 * turn);
}

}  // namespace

Alignment::Alignment(const LateChannel& lateness, double sample_rate_hz)
    : channel_{lateness.channel} {
  const double late = lateness.late_s * sample_rate_hz;
  double sum = 0.0;
  for (std::size_t i = 0; i < kTaps; ++i) {
    const double x = static_cast<double>(i) - kHalf - late;
    taps_[i] = sinc(x) * weight(x / (kHalf + 1));
    sum += taps_[i];
  }
  for (double& tap : taps_) tap /= sum;
}

std::optional<Sample> Alignment::next(const Sample& sample) {
  const bool is_number = std::all_of(sample.accel_mps2.begin(), sample.accel_mps2.end(),
                                     [](double a) { return std::isfinite(a); });
  if (!is_number || sample.tick != last_tick_ + 1) count_ = 0;
  last_tick_ = sample.tick;
  if (!is_number) return sample;
  std::rotate(ring_.begin(), ring_.begin() + 1, ring_.end());
  ring_.back() = sample;
  if (++count_ < kTaps) return std::nullopt;
  Sample out = ring_[kHalf];
  double value = 0.0;
  for (std::size_t i = 0; i < kTaps; ++i) value += taps_[i] * ring_[i].accel_mps2[channel_];
  out.accel_mps2[channel_] = value;
  return out;
}

}  // namespace dampline::app

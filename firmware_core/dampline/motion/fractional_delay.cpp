// SPDX-License-Identifier: MIT
#include "dampline/motion/fractional_delay.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline {
namespace {

double sinc(double x) {
  const double turn = std::numbers::pi * x;
  return std::abs(turn) < 1e-9 ? 1.0 : std::sin(turn) / turn;
}

}  // namespace

FractionalDelay::FractionalDelay(const ChannelLateness& late_s, double sample_rate_hz) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    late_[c] = late_s[c] != 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < kTaps; ++i) {
      const double x = static_cast<double>(i) - kHalf - late_s[c] * sample_rate_hz;
      taps_[c][i] = sinc(x) * blackman(x / (kHalf + 1));
      sum += taps_[c][i];
    }
    for (double& tap : taps_[c]) tap /= sum;
  }
}

std::optional<Sample> FractionalDelay::next(const Sample& sample) {
  const bool is_number = std::all_of(sample.accel_mps2.begin(), sample.accel_mps2.end(),
                                     [](double a) { return std::isfinite(a); });
  if (!is_number || sample.tick != last_tick_ + 1) count_ = 0;
  last_tick_ = sample.tick;
  if (!is_number) return sample;
  std::rotate(ring_.begin(), ring_.begin() + 1, ring_.end());
  ring_.back() = sample;
  if (++count_ < kTaps) return std::nullopt;
  Sample out = ring_[kHalf];
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (!late_[c]) continue;
    double value = 0.0;
    for (std::size_t i = 0; i < kTaps; ++i) value += taps_[c][i] * ring_[i].accel_mps2[c];
    out.accel_mps2[c] = value;
  }
  return out;
}

}  // namespace dampline

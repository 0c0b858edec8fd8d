// SPDX-License-Identifier: MIT
#include "app/identify/thinner.hpp"

#include <cmath>
#include <numbers>

namespace dampline::app {
namespace {

constexpr double kMostHz = 400.0;
constexpr double kKaiserBeta = 5.65;  // 60 dB
constexpr double kCutoff = 0.44;      // of the lower rate, -6 dB

/// Low pass of 2 * half + 1 taps that sum to 1; `cutoff` in periods per sample.
std::vector<double> low_pass(std::int64_t half, double cutoff) {
  std::vector<double> taps;
  double sum = 0.0;
  for (std::int64_t i = -half; i <= half; ++i) {
    const double x = 2.0 * std::numbers::pi * cutoff * static_cast<double>(i);
    const double place = static_cast<double>(i) / static_cast<double>(half + 1);
    const double window = std::cyl_bessel_i(0.0, kKaiserBeta * std::sqrt(1.0 - place * place));
    taps.push_back((i == 0 ? 1.0 : std::sin(x) / x) * window);
    sum += taps.back();
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

}  // namespace

int thinning(double rate_hz) {
  if (!(rate_hz > kMostHz)) return 1;
  return static_cast<int>(std::ceil(rate_hz / kMostHz));
}

Thinner::Thinner(int factor)
    : factor_{factor},
      half_{std::int64_t{kReach} * factor},
      taps_{low_pass(half_, kCutoff / factor)},
      ring_(taps_.size()) {}

const Sample& Thinner::at(std::int64_t tick) const {
  return ring_[static_cast<std::size_t>(tick) % ring_.size()];
}

bool Thinner::take(const Sample& in, Sample& out) {
  if (factor_ == 1) {
    out = in;
    return true;
  }
  if (in.tick != newest_ + 1) unbroken_from_ = in.tick;
  newest_ = in.tick;
  ring_[static_cast<std::size_t>(in.tick) % ring_.size()] = in;
  const std::int64_t centre = in.tick - half_;
  if (centre - half_ < unbroken_from_ || centre % factor_ != 0) return false;
  filter(centre, out);
  return true;
}

void Thinner::filter(std::int64_t centre, Sample& out) const {
  out = at(centre);
  out.tick = centre / factor_;
  out.accel_mps2 = {};
  for (std::int64_t i = -half_; i <= half_; ++i) {
    const Sample& part = at(centre + i);
    const double tap = taps_[static_cast<std::size_t>(half_ + i)];
    for (std::size_t c = 0; c < kChannels; ++c) out.accel_mps2[c] += tap * part.accel_mps2[c];
    if (std::abs(i) <= factor_)
      out.saturated = static_cast<std::uint8_t>(out.saturated | part.saturated);
  }
}

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/wide.hpp"

namespace dampline {

/// White noise of a signal from the band above 0.43 of its sampling rate (130 Hz at 300 Hz), which
/// the sensors' anti-aliasing filters leave nearly free of motion. The lower quartile of the
/// magnitude is followed, so that the bursts which friction makes at every reversal count little.
/// Whatever else lies in the band is taken for noise: the figure is an upper bound.
class NoiseMeter {
 public:
  NoiseMeter() noexcept {
    double gain = 0.0;
    for (int j = -kHalf; j <= kHalf; ++j) {
      const double u = static_cast<double>(j) / (kHalf + 1);
      const double window = 0.42 + 0.5 * std::cos(kPi * u) + 0.08 * std::cos(2.0 * kPi * u);
      const double sinc = j == 0 ? 2.0 * kWidth : std::sin(2.0 * kPi * kWidth * j) / (kPi * j);
      const double tap = (j % 2 == 0 ? 1.0 : -1.0) * window * sinc;
      const int i = j + kHalf;
      taps_[static_cast<std::size_t>(i)] = tap;
      gain += tap * tap;
    }
    gain_ = gain;
  }

  void update(double x) noexcept {
    window_.push(x);
    if (++since_reset_ < static_cast<std::int64_t>(kTaps)) return;
    follow(std::abs(window_.dot(taps_)));
    ++count_;
  }

  /// The next value does not follow the last one.
  void reset() noexcept { since_reset_ = 0; }

  /// Standard deviation, in the signal's unit.
  [[nodiscard]] double std() const noexcept {
    return quantile_ / (kQuantileOfNormal * std::sqrt(gain_));
  }
  [[nodiscard]] std::int64_t count() const noexcept { return count_; }

 private:
  /// Robbins and Monro's recursion in the logarithm: up when a value lies above, down when below.
  void follow(double magnitude) noexcept {
    if (count_ == 0) quantile_ = magnitude;
    const double step = count_ < kSettled ? 4.0 / static_cast<double>(count_ + 8) : kSlowest;
    quantile_ *= magnitude > quantile_ ? 1.0 + step * kQuantile : 1.0 - step * (1.0 - kQuantile);
  }

  static constexpr double kQuantile = 0.25;
  static constexpr double kQuantileOfNormal = 0.31864;  // of |x|, standard normal
  static constexpr double kSlowest = 0.002;
  static constexpr std::int64_t kSettled = 1992;  // where 4 / (count + 8) has come down to that
  static constexpr double kPi = 3.141592653589793238;
  static constexpr int kHalf = 20;
  static constexpr double kWidth = 0.05;  // half-width of the pass band, of the sampling rate
  static constexpr std::size_t kTaps = 2 * kHalf + 1;
  std::array<double, kTaps> taps_{};
  SlidingWindow<kTaps> window_{};
  double gain_{1.0};
  double quantile_{0.0};
  std::int64_t count_{0};
  std::int64_t since_reset_{0};
};

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>

#include "dampline/sample.hpp"

namespace dampline {

/// Blackman's weight, 1 at 0, 0 from +-1 on.
[[nodiscard]] inline double blackman(double u) {
  if (std::abs(u) >= 1.0) return 0.0;
  const double turn = std::numbers::pi * u;
  return 0.42 + 0.5 * std::cos(turn) + 0.08 * std::cos(2.0 * turn);
}

/// By how much each channel shows the past, s; some 20 ms at most.
using ChannelLateness = std::array<double, kChannels>;

/// Sets late channels right: x(t + late) by a sinc of 49 taps with Blackman's weights, flat up to
/// 0.43 of the sampling rate. Samples come kHalf later.
class FractionalDelay {
 public:
  static constexpr int kHalf = 24;

  FractionalDelay(const ChannelLateness& late_s, double sample_rate_hz);
  /// Takes a sample; the one kHalf before, where all around it are there. Samples that are no
  /// number stay that, and a gap starts anew.
  [[nodiscard]] std::optional<Sample> next(const Sample& sample);

 private:
  static constexpr std::size_t kTaps = 2 * kHalf + 1;

  using Taps = std::array<double, kTaps>;
  std::array<bool, kChannels> late_{};
  std::array<Taps, kChannels> taps_{};
  std::array<Sample, kTaps> ring_{};
  std::size_t count_{0};
  std::int64_t last_tick_{0};
};

}  // namespace dampline

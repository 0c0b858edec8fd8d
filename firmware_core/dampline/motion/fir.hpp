// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "dampline/motion/sliding_window.hpp"

namespace dampline {

/// Finite impulse response of 2 Half + 1 taps around the centre; the output is Half samples late.
template <int Half>
class Fir {
 public:
  static constexpr int kDelay = Half;
  static constexpr std::size_t kTaps = 2 * Half + 1;

  /// Tap k of -Half...Half weighs the sample k before the centre.
  explicit Fir(const std::array<double, kTaps>& taps) noexcept {
    for (std::size_t i = 0; i < kTaps; ++i) taps_[i] = taps[kTaps - 1 - i];
  }

  /// Takes x_n. True when `out` was set to the filtered x_(n-Half).
  bool update(double x, double& out) noexcept {
    window_.push(x);
    if (seen_ < kTaps && ++seen_ < kTaps) return false;
    out = window_.dot(taps_);
    return true;
  }

  void reset() noexcept { seen_ = 0; }

 private:
  std::array<double, kTaps> taps_{};  // of the oldest value first
  SlidingWindow<kTaps> window_{};
  std::size_t seen_{0};
};

}  // namespace dampline

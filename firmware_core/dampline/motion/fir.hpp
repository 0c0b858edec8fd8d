// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

namespace dampline {

/// Finite impulse response of 2 Half + 1 taps around the centre; the output is Half samples late.
template <int Half>
class Fir {
 public:
  static constexpr int kDelay = Half;
  static constexpr std::size_t kTaps = 2 * Half + 1;

  /// Tap k of -Half...Half weighs the sample k before the centre.
  explicit Fir(const std::array<double, kTaps>& taps) noexcept : taps_{taps} {}

  /// Takes x_n. True when `out` was set to the filtered x_(n-Half).
  bool update(double x, double& out) noexcept {
    for (std::size_t i = kTaps - 1; i > 0; --i) x_[i] = x_[i - 1];
    x_[0] = x;
    if (seen_ < kTaps && ++seen_ < kTaps) return false;
    double sum = 0.0;
    for (std::size_t i = 0; i < kTaps; ++i) sum += taps_[i] * x_[i];
    out = sum;
    return true;
  }

  void reset() noexcept { seen_ = 0; }

 private:
  std::array<double, kTaps> taps_;
  std::array<double, kTaps> x_{};
  std::size_t seen_{0};
};

}  // namespace dampline

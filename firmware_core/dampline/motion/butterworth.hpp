// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace dampline {

/// 4th-order Butterworth low pass over `Channels` signals alike, by the bilinear transform with
/// prewarping: exactly -3 dB at the corner.
template <std::size_t Channels>
class ButterworthLowPass {
 public:
  using Values = std::array<double, Channels>;
  ButterworthLowPass(double corner_hz, double rate_hz) noexcept {
    const double k = std::tan(std::numbers::pi * corner_hz / rate_hz);
    for (std::size_t i = 0; i < 2; ++i) {
      const double damping = 2.0 * std::sin(std::numbers::pi * (i == 0 ? 1.0 : 3.0) / 8.0);
      const double norm = 1.0 / (1.0 + damping * k + k * k);
      sections_[i] = {k * k * norm, 2.0 * (k * k - 1.0) * norm, (1.0 - damping * k + k * k) * norm};
    }
  }
  /// One step of all channels.
  [[nodiscard]] Values update(Values x) noexcept {
    for (Biquad& s : sections_) {
      for (std::size_t c = 0; c < Channels; ++c) {
        const double out = s.b * x[c] + s.first[c];
        s.first[c] = 2.0 * s.b * x[c] - s.a1 * out + s.second[c];
        s.second[c] = s.b * x[c] - s.a2 * out;
        x[c] = out;
      }
    }
    return x;
  }

 private:
  struct Biquad {
    double b{0.0};  // numerator b (1, 2, 1)
    double a1{0.0};
    double a2{0.0};
    Values first{};
    Values second{};
  };
  std::array<Biquad, 2> sections_{};
};

}  // namespace dampline

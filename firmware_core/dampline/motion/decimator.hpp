// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numbers>

#include "dampline/sample.hpp"

namespace dampline {

/// Samples of a record that make one of the identification's, whose rate is at most 400 Hz.
[[nodiscard]] inline int decimation(double rate_hz) noexcept {
  constexpr double kMostHz = 400.0;
  if (!(rate_hz > kMostHz)) return 1;
  return static_cast<int>(std::ceil(rate_hz / kMostHz));
}

/// Lowers the rate of samples by a whole factor, without aliases and without delay: a symmetric
/// low pass (Kaiser's window, 60 dB), flat up to 0.46 and closed from 0.5 of the lower rate, then
/// every factor-th sample. Samples that are missing leave out what they would have been part of.
/// Flat so far, because noise is measured between 0.33 and 0.49 of the rate. Some 7 KB for each of
/// kMostFactor.
template <int kMostFactor>
class Decimator {
 public:
  /// Precondition: 1 <= factor <= kMostFactor.
  explicit Decimator(int factor) : factor_{factor}, half_{std::int64_t{kReach} * factor} {
    design();
  }
  /// Takes the record's next sample; true where `out` is the next of the lower rate.
  [[nodiscard]] bool take(const Sample& in, Sample& out) noexcept {
    if (factor_ == 1) {
      out = in;
      return true;
    }
    if (in.tick != newest_ + 1) unbroken_from_ = in.tick;
    newest_ = in.tick;
    ring_[slot(in.tick)] = in;
    const std::int64_t centre = in.tick - half_;
    if (centre - half_ < unbroken_from_ || centre % factor_ != 0) return false;
    filter(centre, out);
    return true;
  }
  [[nodiscard]] int factor() const noexcept { return factor_; }

 private:
  static constexpr int kReach = 48;  // of the filter to either side, in samples of the lower rate
  static constexpr std::size_t kMostTaps = 2 * std::size_t{kReach} * kMostFactor + 1;
  static constexpr double kKaiserBeta = 5.65;  // 60 dB
  static constexpr double kCutoff = 0.48;      // of the lower rate, -6 dB

  [[nodiscard]] std::size_t slot(std::int64_t tick) const noexcept {
    return static_cast<std::size_t>(tick) % static_cast<std::size_t>(2 * half_ + 1);
  }
  /// 2 half_ + 1 taps that sum to 1.
  void design() {
    const double cutoff = kCutoff / factor_;
    double sum = 0.0;
    for (std::int64_t i = -half_; i <= half_; ++i) {
      const double x = 2.0 * std::numbers::pi * cutoff * static_cast<double>(i);
      const double place = static_cast<double>(i) / static_cast<double>(half_ + 1);
      const double window = std::cyl_bessel_i(0.0, kKaiserBeta * std::sqrt(1.0 - place * place));
      double& tap = taps_[static_cast<std::size_t>(i + half_)];
      tap = (i == 0 ? 1.0 : std::sin(x) / x) * window;
      sum += tap;
    }
    for (std::int64_t i = 0; i <= 2 * half_; ++i) taps_[static_cast<std::size_t>(i)] /= sum;
  }
  void filter(std::int64_t centre, Sample& out) const noexcept {
    out = ring_[slot(centre)];
    out.tick = centre / factor_;
    out.accel_mps2 = {};
    std::array<double, kExtras> extra{};
    for (std::int64_t i = -half_; i <= half_; ++i) {
      const Sample& part = ring_[slot(centre + i)];
      const double tap = taps_[static_cast<std::size_t>(half_ + i)];
      for (std::size_t c = 0; c < kChannels; ++c) out.accel_mps2[c] += tap * part.accel_mps2[c];
      for (std::size_t e = 0; e < kExtras; ++e) extra[e] += tap * double{part.extra_mps2[e]};
      if (std::abs(i) <= factor_)
        out.saturated = static_cast<std::uint8_t>(out.saturated | part.saturated);
    }
    for (std::size_t e = 0; e < kExtras; ++e) out.extra_mps2[e] = static_cast<float>(extra[e]);
  }

  int factor_;
  std::int64_t half_;  // of the filter, in samples of the record
  std::array<double, kMostTaps> taps_{};
  std::array<Sample, kMostTaps> ring_{};
  std::int64_t unbroken_from_{0};
  std::int64_t newest_{-1};
};

}  // namespace dampline

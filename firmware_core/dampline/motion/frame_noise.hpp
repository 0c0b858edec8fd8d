// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/motion/anti_alias.hpp"
#include "dampline/numeric/fourier.hpp"
#include "dampline/sample.hpp"

namespace dampline {

/// The frame's sensor over a whole record: its white noise and the corner of its low pass, by its
/// power up to half the sampling rate. Leaps of friction put some there: their acceleration falls
/// as 1 / f, is filtered against aliasing, and is folded at half the rate.
class FrameNoise {
 public:
  FrameNoise(double sample_rate_hz, const AntiAliasConfig& anti_alias);
  /// A gap, or a sample that is no number, starts a new segment.
  void take(const Sample& sample);
  /// rms, what the resolution makes included; 0 of less than about 30 s.
  [[nodiscard]] double noise_mps2() const;
  /// Where its low pass seems to lie, by the leaps from a tenth of the rate on, to some percent: to
  /// be trusted where dry friction has no memory. What lies above a third of the rate is told too
  /// low. 0 of less than about 30 s.
  [[nodiscard]] double corner_hz() const;

 private:
  static constexpr std::size_t kBins = Fourier512::kSize / 2;

  [[nodiscard]] double hz(std::size_t bin) const {
    return rate_hz_ * static_cast<double>(bin) / Fourier512::kSize;
  }
  void add_segment();
  /// A constant and a multiple of what leaps leave behind a filter, from a bin on.
  struct LeapFit {
    double white{0.0};
    std::array<double, kBins> expected{};
  };
  [[nodiscard]] LeapFit fit(const std::array<double, kBins>& folded, std::size_t from,
                            double least) const;

  double rate_hz_;
  AntiAliasConfig sensor_;
  Fourier512 fourier_;
  std::array<double, Fourier512::kSize> window_{};
  std::array<double, Fourier512::kSize> held_{};
  std::size_t count_{0};
  std::int64_t last_tick_{0};
  std::size_t first_shaken_bin_, first_bin_, last_bin_;
  std::array<double, kBins> folded_{};  // shape of what friction leaves
  std::array<double, kBins> power_{};
  double segments_{0.0};
};

}  // namespace dampline

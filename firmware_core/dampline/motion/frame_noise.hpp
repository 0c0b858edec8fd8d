// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/motion/anti_alias.hpp"
#include "dampline/numeric/fourier.hpp"
#include "dampline/sample.hpp"

namespace dampline {

/// White noise of the frame's sensor over a whole record: its power near half the sampling rate,
/// less what leaps of friction put there. Their acceleration falls as 1 / f, is filtered against
/// aliasing, and is folded at half the rate.
class FrameNoise {
 public:
  FrameNoise(double sample_rate_hz, const AntiAliasConfig& anti_alias);
  /// A gap, or a sample that is no number, starts a new segment.
  void take(const Sample& sample);
  /// rms, what the resolution makes included; 0 of less than about 30 s.
  [[nodiscard]] double noise_mps2() const;

 private:
  static constexpr std::size_t kBins = Fourier512::kSize / 2;

  [[nodiscard]] double hz(std::size_t bin) const {
    return rate_hz_ * static_cast<double>(bin) / Fourier512::kSize;
  }
  void add_segment();

  double rate_hz_;
  Fourier512 fourier_;
  std::array<double, Fourier512::kSize> window_{};
  std::array<double, Fourier512::kSize> held_{};
  std::size_t count_{0};
  std::int64_t last_tick_{0};
  std::size_t first_bin_, last_bin_;
  std::array<double, kBins> folded_{};  // shape of what friction leaves
  std::array<double, kBins> power_{};
  double segments_{0.0};
};

}  // namespace dampline

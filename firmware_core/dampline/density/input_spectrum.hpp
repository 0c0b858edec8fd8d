// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// Spectral level of a signal at equally spaced frequencies, streamed: mean of Hann-windowed
/// periodograms of 512 samples that overlap by half (Welch 1967), by Goertzel's recursion, so that
/// no sample is stored. The recursion runs over halves of 256 samples without a window; two halves
/// make a transform, and the window is three neighbouring lines of it. Each sample costs the same
/// but the last of a half, with some 50 operations a line. At 300 samples a second the lines lie at
/// 1.17, 1.76, ... 28.7 Hz; a constant in the signal reaches none of them.
class InputSpectrum {
 public:
  static constexpr std::size_t kLines = 48;
  static constexpr std::size_t kLength = 512;

  /// Sums of periodograms, mergeable. Two-sided, per Hz.
  struct Sums {
    std::array<double, kLines> power{};
    double weight{0.0};
    void add(const Sums& other, double factor) noexcept;
  };

  explicit InputSpectrum(double sample_rate_hz) noexcept;

  /// Takes the next sample. Adds to `sums`, with `weight`, when a periodogram is complete.
  void update(double x, double weight, Sums& sums) noexcept;
  /// After a gap: open periodograms are dropped.
  void reset() noexcept;

  [[nodiscard]] double frequency_hz(std::size_t line) const noexcept {
    return static_cast<double>(line + kFirstLine) * sample_rate_hz_ / static_cast<double>(kLength);
  }

 private:
  static constexpr std::size_t kFirstLine = 2;  // a Hann window spreads a constant over lines 0, 1
  static constexpr std::size_t kHop = kLength / 2;
  static constexpr std::size_t kLinesUsed =
      52;  // from line kFirstLine - 1 on: neighbours, whole vectors
  using Lines = std::array<double, kLinesUsed>;
  /// A transform of one half, about its first sample.
  struct Half {
    Lines real{};
    Lines imaginary{};
  };
  void end_half(double weight, Sums& sums) noexcept;

  double sample_rate_hz_;
  Lines cosine_{};
  Lines sine_{};
  Lines last_{};
  Lines before_{};
  Half first_{};  // of the transform that the next half completes
  std::size_t place_{0};
  bool has_first_{false};
};

}  // namespace dampline

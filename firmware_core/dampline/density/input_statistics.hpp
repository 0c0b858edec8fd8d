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

/// psi(y) of dv = -(beta y + alpha) dt + psi(y) dW as a polynomial: psi^2 is the conditional mean
/// of the squared input over y, brought to the input's spectral level. (Kisilowski and Urbanski
/// divide each eta_i by a pseudo-random number of no relation to it; the mean of that quotient does
/// not exist.)
class Modulation {
 public:
  static constexpr std::size_t kTerms = 5;
  /// Coefficients of (y / 1 mm)^m; mean over the samples: 1.
  using Polynomial = std::array<double, kTerms>;

  void take(double deflection_m, double input_mps2, double weight) noexcept {
    const double y = 1.0e3 * deflection_m;
    const double squared = input_mps2 * input_mps2;
    double power = weight;
    for (std::size_t m = 0; m < kMoments; ++m) {
      moments_[m] += power;
      if (m < kTerms) squares_[m] += power * squared;
      power *= y;
    }
  }
  void add(const Modulation& other, double factor) noexcept;
  void scale(double factor) noexcept;

  /// psi^2 over its mean. {1, 0, ...} while the samples do not determine it.
  [[nodiscard]] Polynomial shape() const noexcept;
  /// At a deflection; never negative.
  [[nodiscard]] static double at(const Polynomial& shape, double deflection_m) noexcept;

 private:
  static constexpr std::size_t kMoments = 2 * kTerms - 1;
  std::array<double, kMoments> moments_{};
  std::array<double, kTerms> squares_{};
};

/// Mean power of motion and of input over consecutive stretches of the record, in fixed memory:
/// when all slots are full, neighbours become one. With forgetting, the slots are a ring instead.
class BlockPowers {
 public:
  static constexpr std::size_t kSlots = 32;

  /// `memory_blocks` 0: the whole record; else the last three memories.
  explicit BlockPowers(double memory_blocks) noexcept;

  void take(double velocity_mps, double input_mps2) noexcept {
    open_.motion += velocity_mps * velocity_mps;
    open_.input += input_mps2 * input_mps2;
    open_.count += 1.0;
  }
  void close_block() noexcept;
  /// Adds another record's stretches behind these.
  void append(const BlockPowers& other) noexcept;

  struct Change {
    double size{0.0};    ///< largest |ln(power of a quarter / mean power)|, of motion or input
    double chance{0.0};  ///< its standard deviation in a stationary record
    bool known{false};   ///< at least eight stretches
  };
  [[nodiscard]] Change change() const noexcept;

 private:
  struct Power {
    double motion{0.0}, input{0.0}, count{0.0};
    void add(const Power& other) noexcept;
  };
  void push(const Power& slot) noexcept;
  void end_slot() noexcept;
  void coarsen() noexcept;
  [[nodiscard]] Change change_of(double Power::*power) const noexcept;

  bool rings_;
  std::uint32_t blocks_per_slot_{1};
  std::uint32_t blocks_{0};  // in open_
  Power open_{};
  std::array<Power, kSlots> slots_{};
  std::size_t size_{0};
  std::size_t oldest_{0};
};

}  // namespace dampline

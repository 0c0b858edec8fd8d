// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace dampline::sim {

/// Independent random streams of one seed, so that a change of the noise leaves the track alone.
enum class Stream : std::uint64_t {
  kTrack = 1,
  kShortWave,
  kSensors,
  kNodes,
  kTransport,
  kShocks,
  kLateral,
  kFaults
};

/// xoshiro256++ (Blackman and Vigna 2019), seeded by splitmix64; normal numbers by Marsaglia's
/// polar method. Written out because the distributions of the standard library differ between
/// libraries.
class Random {
 public:
  Random(std::uint64_t seed, Stream stream) noexcept {
    std::uint64_t mix = seed ^ (static_cast<std::uint64_t>(stream) * 0xd1342543de82ef95ULL);
    for (auto& word : state_) {
      mix += 0x9e3779b97f4a7c15ULL;
      std::uint64_t z = mix;
      z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
      z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
      word = z ^ (z >> 31U);
    }
  }

  [[nodiscard]] std::uint64_t bits() noexcept {
    const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t shifted = state_[1] << 17U;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }

  /// In [0, 1), 53 bits.
  [[nodiscard]] double uniform() noexcept { return static_cast<double>(bits() >> 11U) * 0x1p-53; }

  /// Mean 0, variance 1.
  [[nodiscard]] double normal() noexcept {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double u = 0.0;
    double v = 0.0;
    double s = 0.0;
    do {
      u = 2.0 * uniform() - 1.0;
      v = 2.0 * uniform() - 1.0;
      s = u * u + v * v;
    } while (s >= 1.0 || s == 0.0);
    const double factor = std::sqrt(-2.0 * std::log(s) / s);
    spare_ = v * factor;
    has_spare_ = true;
    return u * factor;
  }

 private:
  std::array<std::uint64_t, 4> state_{};
  double spare_{0.0};
  bool has_spare_{false};
};

/// x'' + damping x' + stiffness x = gain u; the prime is d/ds, s in metres or seconds.
struct Section {
  double damping{0.0};
  double stiffness{0.0};
  double gain{1.0};
};

/// White noise through up to three second-order sections in a row, sampled every `step`.
///
/// The noise is held over a step, so the discrete solution (matrix exponential) is exact. With unit
/// normal numbers at the input, the one-sided density of the output over angular wave number w is
///   |H(i w)|^2 / pi * (sin(w step / 2) / (w step / 2))^2.
class SectionChain {
 public:
  static constexpr std::size_t kMaxSections = 3;
  SectionChain(const Section* sections, std::size_t count, double step);
  /// One step; `normal` has mean 0 and variance 1.
  void advance(double normal) noexcept;
  /// Output of the last section and its derivatives after the step.
  [[nodiscard]] double value() const noexcept { return state_[2 * count_ - 2]; }
  [[nodiscard]] double first_derivative() const noexcept { return state_[2 * count_ - 1]; }
  [[nodiscard]] double second_derivative() const noexcept { return second_derivative_; }

 private:
  static constexpr std::size_t kMaxStates = 2 * kMaxSections;
  using Vector = std::array<double, kMaxStates>;
  std::array<Section, kMaxSections> sections_{};
  std::size_t count_;
  std::array<Vector, kMaxStates> transition_{};  // columns
  Vector input_{};
  Vector state_{};
  double second_derivative_{0.0};
};

/// Standard deviations of the three outputs of a chain that starts from rest and runs for `steps`.
struct ChainRms {
  double value, first_derivative, second_derivative;
};
[[nodiscard]] ChainRms stationary_rms(SectionChain chain, std::size_t steps) noexcept;

}  // namespace dampline::sim

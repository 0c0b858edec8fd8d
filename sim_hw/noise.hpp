// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/random.hpp"

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

class Random : public dampline::Random {
 public:
  Random(std::uint64_t seed, Stream stream) noexcept
      : dampline::Random{seed, static_cast<std::uint64_t>(stream)} {}
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

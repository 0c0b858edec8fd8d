// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace dampline {

/// xoshiro256++ (Blackman and Vigna 2019), seeded by splitmix64; normal numbers by Marsaglia's
/// polar method. Written out because the distributions of the standard library differ between
/// libraries.
class Random {
 public:
  /// Streams of one seed are independent.
  Random(std::uint64_t seed, std::uint64_t stream) noexcept {
    std::uint64_t mix = seed ^ (stream * 0xd1342543de82ef95ULL);
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

}  // namespace dampline

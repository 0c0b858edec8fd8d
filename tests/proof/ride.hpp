// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <vector>

#include "dampline/sample.hpp"

namespace dampline::proof {

/// A laden car at 80 km/h on a low ORE track, 300 Hz, seed 1: what the sensors say, as the core
/// takes it.
[[nodiscard]] std::vector<Sample> laden_ride(double duration_s);

/// Gives the sample numbers of a ride that begins anew whenever it ends, and damages a few of them:
/// short and very long gaps, clipped, repeated and not finite samples.
class Trouble {
 public:
  /// 1: about once in ten seconds; 10: ten times as rare.
  explicit Trouble(std::int64_t rarity) noexcept : rarity_{rarity} {}
  void apply(Sample& sample) noexcept;

 private:
  std::int64_t rarity_;
  std::int64_t made_{0};
  std::int64_t tick_{0};
};

}  // namespace dampline::proof

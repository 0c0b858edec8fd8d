// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "dampline/numeric/information.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

enum class ResonanceState : std::uint8_t {
  kNotEnough,  ///< fewer than four frequencies
  kNoMotion,   ///< some amplitude is 0: the system does not move there
  kNoPeak,     ///< the amplitude has no maximum inside the swept band
  kFound
};

struct Resonance {
  ResonanceState state{ResonanceState::kNotEnough};
  Estimate rate_rad_s{};  ///< where the amplitude is largest; 0 without kFound
};

/// The frequency of the largest amplitude from a sweep: 1 / A^2 is a parabola in w^2, exactly so
/// for a linear oscillator, (k - w^2)^2 + c^2 w^2, and locally for any other smooth peak.
class ResonanceFit {
 public:
  /// One steady amplitude; frequencies in any order.
  void add(double rate_rad_s, double amplitude) noexcept;
  [[nodiscard]] Resonance resonance() const noexcept;

 private:
  Information<4> factor_;
  int count_{0};
  bool still_{false};
  double lowest_{0.0};
  double highest_{0.0};
};

}  // namespace dampline

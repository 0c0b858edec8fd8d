// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>

#include "dampline/numeric/information.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

/// Amplitude of a signal's part at one known angular frequency, by least squares on
/// 1, cos wt, sin wt: exact for a sinusoid however many periods the record holds.
class HarmonicMeter {
 public:
  explicit HarmonicMeter(double rate_rad_s) noexcept : rate_rad_s_{rate_rad_s} {}

  void add(double time_s, double x) noexcept {
    if (!std::isfinite(time_s) || !std::isfinite(x)) return;
    Information<4>::Row row;
    row << 1.0, std::cos(rate_rad_s_ * time_s), std::sin(rate_rad_s_ * time_s), x;
    factor_.absorb(row);
    ++count_;
  }

  /// Deviation 0 and value 0 where the record does not determine it.
  [[nodiscard]] Estimate amplitude() const noexcept {
    Information<4>::Vector theta;
    if (count_ < 8 || !factor_.solve(theta, 1e-6)) return {};
    const double size = std::hypot(theta[1], theta[2]);
    const double left = factor_.residual_norm();
    const auto degrees = static_cast<double>(count_ - 3);
    return {size, std::sqrt(left * left / degrees * 2.0 / static_cast<double>(count_))};
  }

 private:
  double rate_rad_s_{0.0};
  std::uint64_t count_{0};
  Information<4> factor_;
};

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

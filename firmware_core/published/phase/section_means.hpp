// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/phase/stroboscope.hpp"

namespace dampline {

/// Mean and variance of one quantity (Welford).
class RunningMean {
 public:
  void add(double x) noexcept {
    ++count_;
    const double from_old = x - mean_;
    mean_ += from_old / static_cast<double>(count_);
    squares_ += from_old * (x - mean_);
  }
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] double mean() const noexcept { return mean_; }
  /// Of one sample; 0 with fewer than two.
  [[nodiscard]] double variance() const noexcept {
    return count_ < 2 ? 0.0 : squares_ / static_cast<double>(count_ - 1);
  }

 private:
  std::uint64_t count_{0};
  double mean_{0.0};
  double squares_{0.0};
};

/// The sections of one steady response: per phase the mean point and its scatter, and the input.
template <int Phases>
struct SectionMeans {
  struct AtPhase {
    RunningMean deflection_m, velocity_mps, accel_mps2, input;
  };
  std::array<AtPhase, static_cast<std::size_t>(Phases)> phases{};

  /// Points that are no number, or of a phase that is not there, are left out.
  void add(int phase, const PhasePoint& p, double input) noexcept {
    if (phase < 0 || phase >= Phases || !is_finite(p) || !std::isfinite(input)) return;
    AtPhase& at = phases[static_cast<std::size_t>(phase)];
    at.deflection_m.add(p.deflection_m);
    at.velocity_mps.add(p.velocity_mps);
    at.accel_mps2.add(p.accel_mps2);
    at.input.add(input);
  }
};

}  // namespace dampline

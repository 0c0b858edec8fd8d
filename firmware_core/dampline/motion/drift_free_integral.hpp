// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>

#include "dampline/motion/baseline.hpp"
#include "dampline/motion/short_integral.hpp"

namespace dampline {

/// Integral of a signal over time without drift, delay() samples late, linear in phase.
/// A constant in the input gives nothing, a ramp a small constant (2.8 ms^2 times its slope); what
/// lies a little above the corner is exact.
class DriftFreeIntegral {
 public:
  /// `sample_rate_hz` 150...400.
  explicit DriftFreeIntegral(double sample_rate_hz) noexcept
      : short_{1.0 / sample_rate_hz}, baseline_{decimation(sample_rate_hz)} {}

  void set_corner(Baseline::Corner corner) noexcept { baseline_.set_corner(corner); }
  [[nodiscard]] Baseline::Corner corner() const noexcept { return baseline_.corner(); }

  /// Takes x_n. True when `out` was set to the integral at n - delay().
  bool update(double x, double& out) noexcept {
    const double integral = short_.update(x);
    if (++count_ < ShortIntegral::kPoints) return false;
    const bool ready = baseline_.update(integral, out);
    if (std::abs(integral) > kRebaseAt) {
      short_.rebase(integral);
      baseline_.rebase(integral);
    }
    return ready;
  }

  void reset() noexcept {
    count_ = 0;
    short_.reset();
    baseline_.reset();
  }

  [[nodiscard]] int delay() const noexcept { return ShortIntegral::kDelay + baseline_.delay(); }
  /// Samples before the first one that has an integral.
  [[nodiscard]] int first() const noexcept {
    return ShortIntegral::kPoints - 1 - ShortIntegral::kDelay + baseline_.first();
  }

 private:
  static constexpr double kRebaseAt = 64.0;  // far above any motion, far below loss of digits

  /// The odd number of samples nearest to 0.17 s.
  static int decimation(double sample_rate_hz) noexcept {
    return 2 * static_cast<int>(0.085 * sample_rate_hz) + 1;
  }

  std::int64_t count_{0};
  ShortIntegral short_;
  Baseline baseline_;
};

}  // namespace dampline

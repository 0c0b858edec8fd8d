// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>

#include "dampline/snapshot.hpp"

namespace dampline {

/// What the velocity's own error does to friction and spring.
///
/// Friction is taken as that of the velocity that was measured. Noise, rounding and jitter put some
/// of it beside its sign: the level then comes out too high, the spring too soft, alike in every
/// record, so that the scatter of the blocks does not show it. The law's width w does: with w0 of
/// exact sensors and the motion's rms velocity, the level is some 27 % of the share
/// x = (w^2 - w0^2) / v_rms^2 too high, and the spring 0 to 60 % of it too low, the more the more
/// it is the frame that errs. Below 300 samples a second the velocity lacks its fastest part, and
/// the level comes out too low. Studies: docs/adr/0019-velocity-error.md,
/// docs/adr/0024-low-corners.md.
struct VelocityError {
  double sample_rate_hz{0.0};    ///< 0: unknown, and nothing is corrected
  double velocity_rms_mps{0.0};  ///< of the motion; 0: the same

  [[nodiscard]] double share(double law_width_mps) const noexcept {
    constexpr double kExactWidthMps = 1.9e-3;  // of the sensors' low pass
    constexpr double kPerCube = 1.0e4;         // m/s Hz^3, of the distance of samples
    if (!is_known()) return 0.0;
    const double exact_mps =
        kExactWidthMps + kPerCube / (sample_rate_hz * sample_rate_hz * sample_rate_hz);
    const double excess = law_width_mps * law_width_mps - exact_mps * exact_mps;
    return std::max(excess, 0.0) / (velocity_rms_mps * velocity_rms_mps);
  }

  [[nodiscard]] Estimate coulomb(const Estimate& e, double law_width_mps) const noexcept {
    constexpr double kTooHigh = 0.27;
    constexpr double kMoreOrLess = 0.30;  // of that
    const double bias = kTooHigh * share(law_width_mps);
    return corrected(e, (1.0 + lost()) / (1.0 + bias),
                     std::hypot(kMoreOrLess * bias, kLostMoreOrLess * lost()));
  }

  [[nodiscard]] Estimate stiffness(const Estimate& e, double law_width_mps) const noexcept {
    constexpr double kTooLow = 0.30;
    const double bias = kTooLow * share(law_width_mps);
    return corrected(e, 1.0 + bias, std::hypot(bias, kLostMoreOrLess * lost()));
  }

 private:
  static constexpr double kLostMoreOrLess = 0.7;

  [[nodiscard]] bool is_known() const noexcept {
    return sample_rate_hz > 0.0 && velocity_rms_mps > 0.0;
  }

  /// Of the level, what goes with the velocity's part between the samples.
  [[nodiscard]] double lost() const noexcept {
    constexpr double kAmpleHz = 300.0;
    constexpr double kLost = 0.0055;
    if (!is_known()) return 0.0;
    const double ratio = kAmpleHz / sample_rate_hz;
    return kLost * std::max(ratio * ratio - 1.0, 0.0);
  }

  /// `uncertain`: of the value.
  static Estimate corrected(const Estimate& e, double factor, double uncertain) noexcept {
    const double value = factor * e.value;
    return {value, std::hypot(factor * e.std, uncertain * value)};
  }
};

}  // namespace dampline

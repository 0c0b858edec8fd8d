// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "dampline/effect/columns.hpp"

namespace dampline::effect {

/// The frame's pitch, d = a theta - (z_1 - z_2) / 2, as every point of a grid would have it. Each
/// wheelset's damper slides at v +- 2 d', so friction turns the frame only where 2 |d'| exceeds
/// |v|:
///   d'' + 2 r w d' + w^2 (d + s (sign(v + 2 d') - sign(v - 2 d')) / 2) = -(z_1'' - z_2'') / 2
/// with w^2 = 2 k a^2 / I and s = F / (2 k), in short steps.
class PitchBank {
 public:
  explicit PitchBank(double step_s,
                     const std::array<PitchShape, kPitchModes>& shapes = kPitch) noexcept
      : step_s_{step_s} {
    for (std::size_t i = 0; i < kPitchModes; ++i) {
      const double omega = 2.0 * 3.141592653589793238 * shapes[i].frequency_hz;
      spring_ps_[i] = step_s * omega * omega;
      kept_[i] = 1.0 - 2.0 * kPitchDamping * omega * step_s;
      friction_mps_[i] = spring_ps_[i] * shapes[i].slip_m;
    }
  }
  /// One step, with `turn_mps2` = -(z_1'' - z_2'') / 2: the rate leaps from half a step before to
  /// half a step after. Friction takes of it what it can, but no further than to where one damper's
  /// direction changes, so that its stiffness asks for no shorter steps.
  void update(double velocity_mps, double turn_mps2) noexcept {
    const double limit_mps = 0.5 * std::abs(velocity_mps);
    for (std::size_t i = 0; i < kPitchModes; ++i) {
      const double rate =
          kept_[i] * rate_mps_[i] - spring_ps_[i] * angle_m_[i] + step_s_ * turn_mps2;
      const double excess = std::max(std::abs(rate) - limit_mps, 0.0);
      const double taken = std::min(excess, friction_mps_[i]);
      opposed_[i] = taken / friction_mps_[i];
      rate_mps_[i] = rate - std::copysign(taken, rate);
      angle_m_[i] += step_s_ * rate_mps_[i];
    }
  }
  /// Share of friction that turns the frame, (sign(v + 2 d') - sign(v - 2 d')) / 2 without its
  /// sign: what is left of the whole, 1 minus this, moves it up and down.
  [[nodiscard]] double opposed(std::size_t mode) const noexcept { return opposed_[mode]; }
  void reset() noexcept {
    rate_mps_.fill(0.0);
    opposed_.fill(0.0);
    angle_m_.fill(0.0);
  }

 private:
  double step_s_;
  std::array<double, kPitchModes> spring_ps_{};
  std::array<double, kPitchModes> kept_{};
  std::array<double, kPitchModes> friction_mps_{};
  std::array<double, kPitchModes> rate_mps_{};  // half a step ahead
  std::array<double, kPitchModes> opposed_{};
  std::array<double, kPitchModes> angle_m_{};
};

/// u'' + 2 d w u' + w^2 u = f in steps, exact for an input that is linear between samples.
/// Stable for any step; any damping but the critical.
class Resonator {
 public:
  Resonator() = default;
  Resonator(double frequency_hz, double damping_ratio, double step_s) noexcept
      : omega_{2.0 * 3.141592653589793238 * frequency_hz},
        damping_{damping_ratio},
        step_s_{step_s} {
    const double decay = std::exp(-damping_ * omega_ * step_s);
    const double rest = omega_ * omega_ * (1.0 - damping_ * damping_);
    const double root = std::sqrt(std::abs(rest));
    const bool swings = rest > 0.0;
    const double c = swings ? std::cos(root * step_s) : std::cosh(root * step_s);
    const double s = (swings ? std::sin(root * step_s) : std::sinh(root * step_s)) / root;
    from_position_[0] = decay * (c + damping_ * omega_ * s);
    from_rate_[0] = decay * s;
    from_position_[1] = -decay * omega_ * omega_ * s;
    from_rate_[1] = decay * (c - damping_ * omega_ * s);
  }

  /// Takes the input at the end of the step.
  void update(double input) noexcept {
    const double square = omega_ * omega_;
    const double slope = (input - input_) / step_s_;
    // The particular solution of a linear input: (f + slope t) / w^2 - 2 d slope / w^3.
    const double shift = 2.0 * damping_ * slope / (square * omega_);
    const double x = position_ - (input_ / square - shift);
    const double r = rate_ - slope / square;
    position_ = from_position_[0] * x + from_rate_[0] * r + input / square - shift;
    rate_ = from_position_[1] * x + from_rate_[1] * r + slope / square;
    input_ = input;
  }
  void reset() noexcept { position_ = rate_ = input_ = 0.0; }

  [[nodiscard]] double rate() const noexcept { return rate_; }
  /// 2 d w u' + w^2 u: what spring and damper transmit.
  [[nodiscard]] double bend() const noexcept {
    return 2.0 * damping_ * omega_ * rate_ + omega_ * omega_ * position_;
  }
  [[nodiscard]] double acceleration() const noexcept { return input_ - bend(); }

 private:
  double omega_{1.0};
  double damping_{0.1};
  double step_s_{1.0};
  std::array<double, 2> from_position_{};
  std::array<double, 2> from_rate_{};
  double position_{0.0};
  double rate_{0.0};
  double input_{0.0};
};

}  // namespace dampline::effect

// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>

namespace dampline::effect {

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

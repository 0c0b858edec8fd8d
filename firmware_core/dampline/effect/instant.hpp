// SPDX-License-Identifier: MIT
#pragma once
namespace dampline::effect {

/// A value and its rate.
struct Slope {
  double value{0.0};
  double rate{0.0};
};

/// The motion at one sample, each part with its rate of change.
struct Instant {
  Slope deflection_m;
  Slope velocity_mps;
  Slope wheelset1_mps;  ///< z_1', without drift
  Slope wheelset2_mps;
  double turn_mps2{0.0};  ///< -(z_1'' - z_2'') / 2, what makes the frame pitch
};

/// The motion between samples.
struct Point {
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double wheelset1_mps{0.0};
  double wheelset2_mps{0.0};
  double wheelset1_mps2{0.0};
  double wheelset2_mps2{0.0};
  double turn_mps2{0.0};
};

/// Weights of the cubic Hermite polynomial at one place between two samples.
struct Hermite {
  double left, left_rate, right, right_rate, place;

  [[nodiscard]] static constexpr Hermite at(double u, double step_s) noexcept {
    const double r = 1.0 - u;
    return {(1.0 + 2.0 * u) * r * r, step_s * u * r * r, u * u * (3.0 - 2.0 * u),
            -step_s * u * u * r, u};
  }
  [[nodiscard]] constexpr double operator()(const Slope& a, const Slope& b) const noexcept {
    return left * a.value + left_rate * a.rate + right * b.value + right_rate * b.rate;
  }
  [[nodiscard]] Point operator()(const Instant& a, const Instant& b) const noexcept {
    Point p;
    p.deflection_m = (*this)(a.deflection_m, b.deflection_m);
    p.velocity_mps = (*this)(a.velocity_mps, b.velocity_mps);
    p.wheelset1_mps = (*this)(a.wheelset1_mps, b.wheelset1_mps);
    p.wheelset2_mps = (*this)(a.wheelset2_mps, b.wheelset2_mps);
    p.wheelset1_mps2 = (1.0 - place) * a.wheelset1_mps.rate + place * b.wheelset1_mps.rate;
    p.wheelset2_mps2 = (1.0 - place) * a.wheelset2_mps.rate + place * b.wheelset2_mps.rate;
    p.turn_mps2 = (1.0 - place) * a.turn_mps2 + place * b.turn_mps2;
    return p;
  }
};

}  // namespace dampline::effect

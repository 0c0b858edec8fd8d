// SPDX-License-Identifier: MIT
#pragma once
#include "dampline/damping/law_columns.hpp"

namespace dampline {

/// The friction law between samples. Velocity is interpolated by the cubic Hermite polynomial of
/// velocities and measured accelerations, the law is evaluated at four points a sample, and each
/// column is averaged by the hat function of two samples' width, [1 2 3 4 3 2 1] / 16: the exact
/// inner product with a piecewise linear test function. On the samples alone a sign would alias
/// and bias the friction level by about one percent.
class LawAverage {
 public:
  using Lanes = LawColumns::Lanes;

  /// Takes velocity and acceleration (dv/dt) at sample n; returns the averages at n - 1, meaningful
  /// from the third call after reset().
  Lanes update(const LawColumns& law, double velocity_mps, double accel_mps2,
               double step_s) noexcept {
    const double m0 = step_s * last_accel_mps2_;
    const double m1 = step_s * accel_mps2;
    const double v0 = last_velocity_mps_;
    const double v1 = velocity_mps;
    const Lanes p0 = law.lanes(v0);
    // Hermite weights at u = 1/4, 1/2, 3/4: (h00, h10, h01, h11) of u.
    const Lanes p1 = law.lanes((54.0 * v0 + 9.0 * m0 + 10.0 * v1 - 3.0 * m1) / 64.0);
    const Lanes p2 = law.lanes((4.0 * (v0 + v1) + m0 - m1) / 8.0);
    const Lanes p3 = law.lanes((10.0 * v0 + 3.0 * m0 + 54.0 * v1 - 9.0 * m1) / 64.0);
    Lanes average = from_left_ + 0.25F * p0 + 0.1875F * p1 + 0.125F * p2 + 0.0625F * p3;
    from_left_ = 0.0625F * p1 + 0.125F * p2 + 0.1875F * p3;
    last_velocity_mps_ = velocity_mps;
    last_accel_mps2_ = accel_mps2;
    ++count_;
    return average;
  }

  /// True when the value returned last was an average over both neighbours.
  [[nodiscard]] bool complete() const noexcept { return count_ >= 3; }
  void reset() noexcept { count_ = 0; }

 private:
  double last_velocity_mps_{0.0};
  double last_accel_mps2_{0.0};
  Lanes from_left_ = Lanes::Zero();
  int count_{0};
};

}  // namespace dampline

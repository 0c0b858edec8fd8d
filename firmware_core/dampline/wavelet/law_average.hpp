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
               double step_s) noexcept;

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

// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

namespace dampline::sim::reference {

/// Motion and input of a system, sampled every `step_s` from time 0, without measuring error.
/// Outer index: degree of freedom; inner index: sample. All inner vectors have the same length.
struct Trajectory {
  double step_s{0.0};
  std::vector<std::vector<double>> deflection_m;
  std::vector<std::vector<double>> velocity_mps;
  std::vector<std::vector<double>> accel_mps2;
  std::vector<std::vector<double>> force_n;  ///< the input, not the restoring force
};

}  // namespace dampline::sim::reference

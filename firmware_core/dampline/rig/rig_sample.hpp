// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <limits>

namespace dampline {

/// One sampling instant of a rig that measures motion and force.
struct RigSample {
  std::int64_t tick{0};  ///< sample number; consecutive samples differ by 1, a gap by more
  double deflection_m{0.0};
  double velocity_mps{std::numeric_limits<double>::quiet_NaN()};  ///< NaN: not measured
  double force_n{0.0};
};

}  // namespace dampline

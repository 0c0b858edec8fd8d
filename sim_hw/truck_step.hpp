// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>

#include "sim_hw/truck.hpp"

namespace dampline::sim {

/// tanh; beyond 19 it is 1 in double precision.
[[nodiscard]] inline double smooth_sign(double x) noexcept {
  return std::abs(x) > 19.0 ? std::copysign(1.0, x) : std::tanh(x);
}

/// At the share u of a step: the parabola through its start, middle and end.
[[nodiscard]] inline Excitation between(const Excitation& a, const Excitation& m,
                                        const Excitation& b, double u) noexcept {
  const double wa = (1.0 - u) * (1.0 - 2.0 * u);
  const double wm = 4.0 * u * (1.0 - u);
  const double wb = u * (2.0 * u - 1.0);
  Excitation e;
  for (std::size_t i = 0; i < 2; ++i) {
    e.wheelset_mps2[i] =
        wa * a.wheelset_mps2[i] + wm * m.wheelset_mps2[i] + wb * b.wheelset_mps2[i];
  }
  e.force_n = wa * a.force_n + wm * m.force_n + wb * b.force_n;
  return e;
}

}  // namespace dampline::sim

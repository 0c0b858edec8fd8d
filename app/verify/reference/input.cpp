// SPDX-License-Identifier: MIT
#include "app/verify/reference/input.hpp"

#include <cmath>

namespace dampline::sim::reference {

Real force_n(const Input& input, Real time_s) noexcept {
  Real sum = 0;
  for (const Sine& sine : input) {
    const Real phase = (sine.rate_radps + 0.5L * sine.slope_radps2 * time_s) * time_s;
    sum += sine.amplitude_n * std::sin(phase);
  }
  return sum;
}

}  // namespace dampline::sim::reference

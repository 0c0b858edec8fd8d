// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/verify/reference/cooper_verner.hpp"

namespace dampline::sim::reference {

/// One force of an input: amplitude_n sin(phase(t)) with phase' = rate_radps + slope_radps2 t, that
/// is, a sine where the slope is 0 and a linear sweep elsewhere.
struct Sine {
  Real amplitude_n{0};
  Real rate_radps{0};
  Real slope_radps2{0};
};

/// The input of one degree of freedom: a sum of sines.
using Input = std::vector<Sine>;

/// Force of the input at a time, N.
[[nodiscard]] Real force_n(const Input& input, Real time_s) noexcept;

}  // namespace dampline::sim::reference

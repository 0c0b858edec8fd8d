// SPDX-License-Identifier: MIT
#pragma once
#include "dampline/effect/explanation.hpp"

namespace dampline::effect {

/// Fills in the physical parameters of every step and of base and final model.
void describe(double moving_mass_kg, Explanation& out) noexcept;

}  // namespace dampline::effect

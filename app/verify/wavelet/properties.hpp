// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/verify/wavelet/figures.hpp"

// What the method does beside the publication's tables.
namespace dampline::app {

/// The forced Duffing oscillator with deflection and force in 12 bit, at several levels.
[[nodiscard]] CaseFigures quantised_duffing_result();
/// The forced Duffing oscillator whose stiffness drops by 20 % in the middle of the run.
[[nodiscard]] std::vector<CheckGroup> stiffness_drop();
/// Recursive against batch, in double and in single precision.
[[nodiscard]] std::vector<CheckGroup> recursive_against_batch();

}  // namespace dampline::app

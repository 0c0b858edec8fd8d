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
/// Oscillators from two 12-bit accelerometers at 300 Hz, without deflection or force: rms errors
/// over so many seeds.
[[nodiscard]] std::vector<CheckGroup> accelerometers_alone(int seeds);

/// Table 17: one degree of freedom, the true, the linear and a model of seven terms.
[[nodiscard]] std::vector<CheckGroup> single_selection();
/// Table 18: the chain of two masses, ten terms.
[[nodiscard]] std::vector<CheckGroup> chain_selection();
/// Tables 17 and 18 as equation 35 has them: the error of the simulated response.
[[nodiscard]] std::vector<CheckGroup> single_responses();
[[nodiscard]] std::vector<CheckGroup> chain_responses();
/// Which reading of the sweep of tables 3 and 4 fits the published coefficients of variation.
[[nodiscard]] std::vector<CheckGroup> sweep_readings();

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include "app/verify/wavelet/cases.hpp"
#include "app/verify/wavelet/figures.hpp"

// One function per published case: simulated, estimated, with its bounds. Spread over several files
// for the sake of compile time.
namespace dampline::app {

[[nodiscard]] CaseFigures product_result();
/// The product x x' by equation 11.
[[nodiscard]] CaseFigures product_by_omega_result();
[[nodiscard]] CaseFigures duffing_result(Drive drive);
[[nodiscard]] CaseFigures van_der_pol_result(Drive drive);
[[nodiscard]] CaseFigures duffing_chain_result(bool forced);
[[nodiscard]] CaseFigures van_der_pol_chain_result(bool forced);
[[nodiscard]] CaseFigures coulomb_free_result();
/// The same oscillator by the decrements of its extremes.
[[nodiscard]] CaseFigures coulomb_decrement_result();
[[nodiscard]] CaseFigures coulomb_forced_result();
[[nodiscard]] CaseFigures coulomb_tanh_result();
/// The same system with the three other smooth representations of sign(v); table "signs".
[[nodiscard]] CaseFigures coulomb_erf_result();
[[nodiscard]] CaseFigures coulomb_arctangent_result();
[[nodiscard]] CaseFigures coulomb_rational_result();
[[nodiscard]] CaseFigures coulomb_chain_result();
[[nodiscard]] CaseFigures linear_coulomb_result(double ratio, double slope_npm);
/// Simulated and estimated with tanh(200 v) for sign v, b = 0.6.
[[nodiscard]] CaseFigures linear_coulomb_tanh_result(double slope_npm);
[[nodiscard]] CaseFigures teflon_result();

}  // namespace dampline::app

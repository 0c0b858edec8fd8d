// SPDX-License-Identifier: MIT
#pragma once
#include <gmpxx.h>

#include <vector>

namespace dampline::generate {

inline constexpr unsigned kBits = 512;

/// Daubechies' low-pass filter of 2N taps with the zeros inside the unit circle (extremal phase),
/// to about 150 digits; sum h_k = sqrt(2) (Daubechies, Ten Lectures on Wavelets, section 6.1).
/// Unlike the connection coefficients, it is not rational.
[[nodiscard]] std::vector<mpf_class> low_pass(int vanishing_moments);

}  // namespace dampline::generate

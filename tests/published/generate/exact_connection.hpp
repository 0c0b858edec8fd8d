// SPDX-License-Identifier: MIT
#pragma once
#include <gmpxx.h>

#include <vector>

namespace dampline::generate {

/// The two-scale mask of the autocorrelation Phi of the Daubechies scaling function with N
/// vanishing moments, which is the interpolant of Deslauriers and Dubuc (1989) of order 2 N:
///   Phi(y) = sum_k a_k Phi(2 y - k),   k = -(2N-1)...2N-1,   all a_k rational.
/// Element i is a_(i - (2N-1)).
[[nodiscard]] std::vector<mpq_class> interpolant_mask(int vanishing_moments);

/// Connection coefficients Gamma^(n)_k = int phi^(n)(y - k) phi(y) dy = (-1)^n Phi^(n)(k), exact
/// (Beylkin 1992; Latto, Resnikoff and Tenenbaum 1991). They solve the two-scale relation of
/// Phi^(n) at the integers with sum_k k^n Gamma^(n)_k = n!. Element i belongs to k = i - (2N-2).
/// `order` is 1 or 2; N at least 3, since phi of N = 2 has no second derivative to integrate.
[[nodiscard]] std::vector<mpq_class> connection(int vanishing_moments, int order);

}  // namespace dampline::generate

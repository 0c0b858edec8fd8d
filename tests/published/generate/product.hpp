// SPDX-License-Identifier: MIT
#pragma once
#include <gmpxx.h>

#include <string>
#include <vector>

namespace dampline::generate {

/// Three-term connection coefficients Omega(p, q) = int phi(y) phi'(y - p) phi(y - q) dy of the
/// scaling function with N vanishing moments, |p|, |q|, |p - q| <= 2N - 2 (Latto, Resnikoff and
/// Tenenbaum 1991): what equation 11 of Ghanem and Romeo (2001) makes the product x x' of. They
/// solve their two-scale relation with sum_p p Omega(p, q) = delta_q0 and sum_p Omega(p, q) = 0.
/// Element [p + 2N-2][q + 2N-2]; zero outside the support. To about 140 digits: they are not
/// rational.
[[nodiscard]] std::vector<std::vector<mpf_class>> product_connection(int vanishing_moments);

/// The text of firmware_core/published/wavelet/product_table.hpp.
[[nodiscard]] std::string product_header();

}  // namespace dampline::generate

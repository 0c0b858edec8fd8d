// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

namespace dampline {

/// (1 - u^2)^8 and its derivatives from binomial coefficients: the truth for the tables, by another
/// way than theirs.
inline long double bump_derivative(int order, long double u) {
  if (u <= -1.0L || u >= 1.0L) return 0.0L;
  std::array<long double, 17> coefficient{};
  long double binomial = 1.0L;
  for (std::size_t k = 0; k <= 8; ++k) {
    coefficient[2 * k] = k % 2 == 0 ? binomial : -binomial;
    binomial = binomial * static_cast<long double>(8 - k) / static_cast<long double>(k + 1);
  }
  for (int d = 0; d < order; ++d) {
    for (std::size_t i = 1; i < coefficient.size(); ++i)
      coefficient[i - 1] = static_cast<long double>(i) * coefficient[i];
    coefficient.back() = 0.0L;
  }
  long double value = 0.0L;
  for (std::size_t i = coefficient.size(); i-- > 0;) value = value * u + coefficient[i];
  return value;
}

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

namespace dampline {

/// Polynomials of degree 0...Count - 1, orthonormal over N equally spaced points (Gram; also
/// discrete Legendre or Chebyshev polynomials). With x = i - (N - 1) / 2,
///   b_(j+1) p_(j+1) = x p_j - b_j p_(j-1),   b_j^2 = j^2 (N^2 - j^2) / (4 (4 j^2 - 1)).
template <int Count, int N>
class GramPolynomials {
  static_assert(Count >= 1 && N > Count);

 public:
  using Values = std::array<double, static_cast<std::size_t>(Count)>;

  GramPolynomials() noexcept {
    for (std::size_t j = 1; j < b_.size(); ++j) {
      const double square = static_cast<double>(j) * static_cast<double>(j);
      b_[j] =
          std::sqrt(square * (static_cast<double>(N) * N - square) / (4.0 * (4.0 * square - 1.0)));
    }
  }

  /// All of them at point i, 0 <= i < N.
  [[nodiscard]] Values at(int i) const noexcept {
    const double x = i - 0.5 * (N - 1);
    Values p{};
    p[0] = 1.0 / std::sqrt(static_cast<double>(N));
    if constexpr (Count > 1) p[1] = x * p[0] / b_[1];
    for (std::size_t j = 2; j < p.size(); ++j) p[j] = (x * p[j - 1] - b_[j - 1] * p[j - 2]) / b_[j];
    return p;
  }

  /// sum_j c_j p_j.
  [[nodiscard]] static double sum(const Values& coefficients, const Values& at) noexcept {
    double out = 0.0;
    for (std::size_t j = 0; j < at.size(); ++j) out += coefficients[j] * at[j];
    return out;
  }

 private:
  Values b_{};
};

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cmath>

namespace dampline {

/// Solves A x = b for a small positive definite A by Cholesky's method, in plain loops: Eigen's
/// solvers fall back to the heap for large matrices and bring that reference into the library.
/// What A does not determine comes out as NaN.
template <int N>
Eigen::Matrix<double, N, 1> solve_cholesky(const Eigen::Matrix<double, N, N>& a,
                                           const Eigen::Matrix<double, N, 1>& b) noexcept {
  Eigen::Matrix<double, N, N> l = Eigen::Matrix<double, N, N>::Zero();
  for (int j = 0; j < N; ++j) {
    for (int i = j; i < N; ++i) {
      double sum = a(i, j);
      for (int k = 0; k < j; ++k) sum -= l(i, k) * l(j, k);
      l(i, j) = i == j ? std::sqrt(sum) : sum / l(j, j);
    }
  }
  Eigen::Matrix<double, N, 1> x = b;
  for (int i = 0; i < N; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= l(i, k) * x[k];
    x[i] /= l(i, i);
  }
  for (int i = N - 1; i >= 0; --i) {
    for (int k = i + 1; k < N; ++k) x[i] -= l(k, i) * x[k];
    x[i] /= l(i, i);
  }
  return x;
}

}  // namespace dampline

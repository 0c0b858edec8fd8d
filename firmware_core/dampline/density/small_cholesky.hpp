// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cmath>

namespace dampline {

/// Cholesky factor of the leading `size` rows and columns of a positive definite matrix, for
/// problems whose size the data decide. Plain loops: no reference to the heap.
template <int Max>
class SmallCholesky {
 public:
  using Matrix = Eigen::Matrix<double, Max, Max>;
  using Vector = Eigen::Matrix<double, Max, 1>;

  /// False when the matrix is not positive definite to within rounding.
  [[nodiscard]] bool factor(const Matrix& a, int size) noexcept {
    size_ = size;
    for (int j = 0; j < size; ++j) {
      for (int i = j; i < size; ++i) {
        double sum = a(i, j);
        for (int k = 0; k < j; ++k) sum -= l_(i, k) * l_(j, k);
        if (i != j) {
          l_(i, j) = sum / l_(j, j);
          continue;
        }
        if (!(sum > kTolerance * a(j, j))) return false;
        l_(j, j) = std::sqrt(sum);
      }
    }
    return true;
  }

  /// b becomes L^-1 b.
  void forward(Vector& b) const noexcept {
    for (int i = 0; i < size_; ++i) {
      for (int k = 0; k < i; ++k) b[i] -= l_(i, k) * b[k];
      b[i] /= l_(i, i);
    }
  }
  /// b becomes L^-T b.
  void backward(Vector& b) const noexcept {
    for (int i = size_ - 1; i >= 0; --i) {
      for (int k = i + 1; k < size_; ++k) b[i] -= l_(k, i) * b[k];
      b[i] /= l_(i, i);
    }
  }
  /// b becomes A^-1 b.
  void solve(Vector& b) const noexcept {
    forward(b);
    backward(b);
  }

 private:
  static constexpr double kTolerance = 1e-12;
  Matrix l_ = Matrix::Zero();
  int size_{0};
};

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace dampline {

/// Cholesky factor L of the leading `size` rows and columns of a positive definite matrix. Plain
/// loops: Eigen's solvers fall back to the heap for large matrices and bring that reference into
/// the library.
template <int Max>
class Cholesky {
 public:
  using Matrix = Eigen::Matrix<double, Max, Max>;
  using Vector = Eigen::Matrix<double, Max, 1>;

  /// False when a pivot is not above `tolerance` times its diagonal element. `a` may have more rows
  /// and columns.
  template <class Square>
  [[nodiscard]] bool factor(const Square& a, int size, double tolerance = 1e-12) noexcept {
    size_ = size;
    for (int j = 0; j < size; ++j) {
      for (int i = j; i < size; ++i) {
        double sum = a(i, j);
        for (int k = 0; k < j; ++k) sum -= l_(i, k) * l_(j, k);
        if (i != j) {
          l_(i, j) = sum / l_(j, j);
          continue;
        }
        if (!(sum > tolerance * a(j, j))) return false;
        l_(j, j) = std::sqrt(sum);
      }
    }
    return true;
  }

  /// b becomes L^-1 b.
  template <class Column>
  void forward(Column& b) const noexcept {
    for (int i = 0; i < size_; ++i) {
      for (int k = 0; k < i; ++k) b[i] -= l_(i, k) * b[k];
      b[i] /= l_(i, i);
    }
  }
  /// b becomes L^-T b.
  template <class Column>
  void backward(Column& b) const noexcept {
    for (int i = size_ - 1; i >= 0; --i) {
      for (int k = i + 1; k < size_; ++k) b[i] -= l_(k, i) * b[k];
      b[i] /= l_(i, i);
    }
  }
  /// b becomes A^-1 b.
  template <class Column>
  void solve(Column& b) const noexcept {
    forward(b);
    backward(b);
  }

 private:
  Matrix l_ = Matrix::Zero();
  int size_{0};
};

/// The middle S of a covariance A^-1 S A^-1 from the scores of blocks in their order in time:
///   S = sum s_b s_b' + 1/2 sum (s_b s_(b-1)' + s_(b-1) s_b'),
/// valid for rows that are correlated and of unequal variance (Newey and West 1987, one lag).
template <int N>
class ScoreScatter {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Square = Eigen::Matrix<double, N, N>;

  /// Of the first `size` unknowns.
  void add(const Vector& score, int size = N) noexcept {
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j)
        sum_(i, j) += score[i] * score[j] + 0.5 * (score[i] * last_[j] + last_[i] * score[j]);
    }
    last_ = score;
  }
  /// `inverse`: A^-1.
  [[nodiscard]] Square covariance(const Square& inverse) const noexcept {
    return inverse.lazyProduct(sum_.lazyProduct(inverse).eval());
  }

 private:
  Square sum_ = Square::Zero();
  Vector last_ = Vector::Zero();
};

/// Solves A x = b; all NaN where A is not positive definite.
template <int N>
Eigen::Matrix<double, N, 1> solve_cholesky(const Eigen::Matrix<double, N, N>& a,
                                           Eigen::Matrix<double, N, 1> b) noexcept {
  Cholesky<N> cholesky;
  if (cholesky.factor(a, N, 0.0))
    cholesky.solve(b);
  else
    b.setConstant(std::numeric_limits<double>::quiet_NaN());
  return b;
}

}  // namespace dampline

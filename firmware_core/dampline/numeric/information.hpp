// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "dampline/numeric/wide.hpp"

namespace dampline {
namespace detail {

/// Two rows by an angle: plain loops over memory that does not overlap, so that compilers vectorise
/// them.
template <class Scalar>
inline void rotate(Scalar* __restrict upper, Scalar* __restrict lower, int count, Scalar c,
                   Scalar s) noexcept {
  for (int j = 0; j < count; ++j) {
    const Scalar above = upper[j];
    const Scalar below = lower[j];
    upper[j] = c * above + s * below;
    lower[j] = c * below - s * above;
  }
}

}  // namespace detail

/// Square-root information of a least-squares problem: the upper-triangular factor R of [A | b],
/// R'R = [A b]'[A b], built row by row with Givens rotations (Golub and Van Loan, Matrix
/// Computations, 5.1.8; Bierman, Factorization Methods for Discrete Sequential Estimation, ch. IV).
///
/// Columns counts A's columns and b, which is the last. Factors of the same columns merge exactly:
/// information adds. Nothing is ever subtracted, so nothing can become indefinite.
template <int Columns, class Scalar = double>
class Information {
  static_assert(Columns >= 2);

  static constexpr int kVector = 4;
  /// Of a panel's rows: a vector that begins within the columns ends within the stride.
  static constexpr auto kStride = static_cast<std::size_t>(Columns + kVector - 1);

 public:
  static constexpr int kColumns = Columns;
  static constexpr int kUnknowns = Columns - 1;
  static constexpr std::size_t kSize = static_cast<std::size_t>(Columns) * (Columns + 1) / 2;
  using Row = Eigen::Matrix<Scalar, Columns, 1>;
  using Gram = Eigen::Matrix<Scalar, Columns, Columns>;
  using Vector = Eigen::Matrix<Scalar, Columns - 1, 1>;

  /// Adds one equation. Entries of `row` before `first` must be zero. About 3 Columns^2 operations.
  void absorb(Row row, int first = 0) noexcept {
    Scalar* r = factor_.data() + offset(first);
    for (int i = first; i < Columns; r += Columns - i, ++i) {
      const Scalar x = row[i];
      const Scalar square = x * x;
      if (square == Scalar(0)) continue;  // also what underflows: no angle can be formed from it
      const Scalar norm = std::sqrt(r[0] * r[0] + square);
      const Scalar c = r[0] / norm;
      const Scalar s = x / norm;
      r[0] = norm;
      detail::rotate(r + 1, row.data() + i + 1, Columns - i - 1, c, s);
    }
  }

  /// Rows that are added together, with a margin that whole vectors may reach into.
  template <std::size_t Rows>
  class Panel {
   public:
    static constexpr std::size_t kRows = Rows;
    void set(std::size_t i, const Row& row) noexcept {
      clear(i);
      for (int j = 0; j < Columns; ++j) at(i)[j] = row[j];
    }
    [[nodiscard]] Row row(std::size_t i) const noexcept { return Row::Map(&numbers_[i * kStride]); }
    void scale(std::size_t i, Scalar factor) noexcept {
      for (std::size_t j = 0; j < kStride; ++j) at(i)[j] *= factor;
    }
    void clear(std::size_t i) noexcept {
      for (std::size_t j = 0; j < kStride; ++j) at(i)[j] = Scalar(0);
    }

   private:
    friend class Information;
    [[nodiscard]] Scalar* at(std::size_t i) noexcept { return &numbers_[i * kStride]; }
    std::array<Scalar, Rows * kStride> numbers_{};
  };

  /// Adds several equations at once, with one Householder reflection for each column (Golub and Van
  /// Loan, 5.1.3): one square root for all of them, where absorb() needs one each. About
  /// 2 Columns^2 operations for each equation.
  template <std::size_t Rows>
  DAMPLINE_WIDE void absorb_panel(Panel<Rows>& panel) noexcept {
    for (int i = 0; i < Columns; ++i) {
      Scalar* r = factor_.data() + offset(i);
      Scalar square = 0;
      for (std::size_t m = 0; m < Rows; ++m) square += panel.at(m)[i] * panel.at(m)[i];
      if (square <= kLeastSquare) continue;  // too small to have a direction
      const Scalar norm = std::sqrt(r[0] * r[0] + square);
      const Scalar sum = r[0] + norm;
      reflect(panel, i, r, -square / sum, Scalar(1) / norm, -sum / (norm * square));
      r[0] = norm;
    }
  }

  /// Adds row `i` of another factor; all `Columns` rows added make the merged factor.
  void absorb_row_of(const Information& other, int i) noexcept { absorb(other.row(i), i); }

  void merge(const Information& other) noexcept {
    for (int i = 0; i < Columns; ++i) absorb_row_of(other, i);
  }

  /// Forgetting: scales the information by factor^2.
  void scale(Scalar factor) noexcept {
    for (Scalar& x : factor_) x *= factor;
  }

  void clear() noexcept { factor_.fill(Scalar(0)); }

  [[nodiscard]] Scalar at(int i, int j) const noexcept {
    return j < i ? Scalar(0) : factor_[offset(i) + static_cast<std::size_t>(j - i)];
  }

  [[nodiscard]] Row row(int i) const noexcept {
    Row out = Row::Zero();
    for (int j = i; j < Columns; ++j) out[j] = at(i, j);
    return out;
  }

  /// The normal equations [A b]'[A b].
  [[nodiscard]] Gram gram() const noexcept {
    Gram out = Gram::Zero();
    for (int i = 0; i < Columns; ++i) {
      const Row r = row(i);
      out += r.lazyProduct(r.transpose());
    }
    return out;
  }

  /// Adds to `out` the information about other columns [A b] * map, weighted.
  template <int Other>
  void add_mapped(const Eigen::Matrix<Scalar, Columns, Other>& map, Scalar weight,
                  Information<Other, Scalar>& out) const noexcept {
    const Scalar root = std::sqrt(weight);
    for (int i = 0; i < Columns; ++i) {
      out.absorb(root * map.transpose().lazyProduct(row(i)));
    }
  }

  /// Least-squares solution by back substitution. False when a pivot is below `tolerance` times its
  /// column's norm: the data do not determine this unknown.
  [[nodiscard]] bool solve(Vector& theta, Scalar tolerance = Scalar(1e-9)) const noexcept {
    for (int i = kUnknowns - 1; i >= 0; --i) {
      if (!(std::abs(at(i, i)) > tolerance * column_norm(i))) return false;
      Scalar sum = at(i, kUnknowns);
      for (int j = i + 1; j < kUnknowns; ++j) sum -= at(i, j) * theta[j];
      theta[i] = sum / at(i, i);
    }
    return true;
  }

  /// (A'A)^-1, from the inverse of the triangular factor. Only after solve() succeeded.
  [[nodiscard]] Eigen::Matrix<Scalar, kUnknowns, kUnknowns> inverse() const noexcept {
    Eigen::Matrix<Scalar, kUnknowns, kUnknowns> r =
        Eigen::Matrix<Scalar, kUnknowns, kUnknowns>::Zero();
    for (int j = 0; j < kUnknowns; ++j) {
      r(j, j) = Scalar(1) / at(j, j);
      for (int i = j - 1; i >= 0; --i) {
        Scalar sum = 0;
        for (int k = i + 1; k <= j; ++k) sum -= at(i, k) * r(k, j);
        r(i, j) = sum / at(i, i);
      }
    }
    return r.lazyProduct(r.transpose());
  }

  /// Norm of what the solution leaves: |A theta - b|.
  [[nodiscard]] Scalar residual_norm() const noexcept { return std::abs(at(kUnknowns, kUnknowns)); }

  /// Norm of column j of [A b].
  [[nodiscard]] Scalar column_norm(int j) const noexcept {
    Scalar sum = 0;
    for (int i = 0; i <= j; ++i) sum += at(i, j) * at(i, j);
    return std::sqrt(sum);
  }

  /// The packed upper triangle, row after row: the exchange form.
  [[nodiscard]] const std::array<Scalar, kSize>& packed() const noexcept { return factor_; }
  [[nodiscard]] std::array<Scalar, kSize>& packed() noexcept { return factor_; }

 private:
  static constexpr Scalar kLeastSquare = Scalar(1e4) * std::numeric_limits<Scalar>::min();

  // The columns after i of the factor's row `r` and of the panel, reflected at v = (first,
  // panel[.][i]), where first = r - |r|, formed without cancellation: x + v (v'x) / (|r| first). By
  // whole vectors: of the last one, what lies beyond the row is put back, or in the margin.
  template <std::size_t Rows>
  static void reflect(Panel<Rows>& panel, int i, Scalar* __restrict r, Scalar first,
                      Scalar per_norm, Scalar per_both) noexcept {
    std::array<Scalar, Rows> v{};
    for (std::size_t m = 0; m < Rows; ++m) v[m] = panel.at(m)[i];
    Scalar* __restrict upper = r + 1;
    Scalar* __restrict below = panel.at(0) + i + 1;
    const int count = Columns - i - 1;
    const auto one = [&](int j) {
      Scalar along = first * upper[j];
      for (std::size_t m = 0; m < Rows; ++m) along += v[m] * below[m * kStride + place(j)];
      upper[j] += along * per_norm;
      along *= per_both;
      for (std::size_t m = 0; m < Rows; ++m) below[m * kStride + place(j)] += v[m] * along;
    };
    const auto vector = [&](int j) {
      Four along = first * four(upper + j).numbers;
      for (std::size_t m = 0; m < Rows; ++m) along += v[m] * four(below + j + m * kStride).numbers;
      four(upper + j).numbers += along * per_norm;
      along *= per_both;
      for (std::size_t m = 0; m < Rows; ++m) four(below + j + m * kStride).numbers += v[m] * along;
    };
    if (count < kVector) {
      for (int j = 0; j < count; ++j) one(j);
      return;
    }
    const Four beyond = four(upper + count).numbers;
    for (int j = 0; j < count; j += kVector) vector(j);
    four(upper + count).numbers = beyond;
  }
  using Four = typename FourInMemory<Scalar>::Numbers;
  static FourInMemory<Scalar>& four(Scalar* numbers) noexcept { return wide(numbers); }
  static constexpr std::size_t place(int j) noexcept { return static_cast<std::size_t>(j); }
  static constexpr std::size_t offset(int i) noexcept {
    return static_cast<std::size_t>(i * Columns - i * (i - 1) / 2);
  }
  std::array<Scalar, kSize> factor_{};
};

/// The same of a problem whose number of unknowns is known at run time only, at most `Most`. The
/// equation's right-hand side is column size().
template <int Most>
class RunTimeInformation {
 public:
  using Row = std::array<double, static_cast<std::size_t>(Most) + 1>;
  using Vector = std::array<double, static_cast<std::size_t>(Most)>;

  explicit RunTimeInformation(int unknowns) noexcept : unknowns_{unknowns} {}

  [[nodiscard]] int size() const noexcept { return unknowns_; }
  [[nodiscard]] double at(int i, int j) const noexcept { return rows_[index(i)][index(j)]; }
  [[nodiscard]] const Row& row(int i) const noexcept { return rows_[index(i)]; }

  void absorb(Row row) noexcept {
    for (int i = 0; i <= unknowns_; ++i) {
      const double x = row[index(i)];
      if (x == 0.0) continue;
      Row& r = rows_[index(i)];
      const double norm = std::sqrt(r[index(i)] * r[index(i)] + x * x);
      const double c = r[index(i)] / norm;
      const double s = x / norm;
      detail::rotate(&r[index(i)], &row[index(i)], unknowns_ - i + 1, c, s);
    }
  }

  void merge(const RunTimeInformation& other) noexcept {
    for (int i = 0; i <= unknowns_; ++i) absorb(other.row(i));
  }

  /// The first unknown that the data do not determine, or -1.
  [[nodiscard]] int undetermined(double tolerance = 1e-7) const noexcept {
    for (int j = 0; j < unknowns_; ++j)
      if (!(std::abs(at(j, j)) > tolerance * column_norm(j))) return j;
    return -1;
  }

  /// Precondition: every unknown is determined.
  [[nodiscard]] Vector solve() const noexcept {
    Vector theta{};
    for (int i = unknowns_ - 1; i >= 0; --i) {
      double sum = at(i, unknowns_);
      for (int j = i + 1; j < unknowns_; ++j) sum -= at(i, j) * theta[index(j)];
      theta[index(i)] = sum / at(i, i);
    }
    return theta;
  }

  /// Solves R' x = y, then R z = x: z = (R'R)^-1 y.
  [[nodiscard]] Vector solve_normal(const Vector& y) const noexcept {
    Vector x{};
    for (int i = 0; i < unknowns_; ++i) {
      double sum = y[index(i)];
      for (int j = 0; j < i; ++j) sum -= at(j, i) * x[index(j)];
      x[index(i)] = sum / at(i, i);
    }
    for (int i = unknowns_ - 1; i >= 0; --i) {
      double sum = x[index(i)];
      for (int j = i + 1; j < unknowns_; ++j) sum -= at(i, j) * x[index(j)];
      x[index(i)] = sum / at(i, i);
    }
    return x;
  }

  [[nodiscard]] double column_norm(int j) const noexcept {
    double sum = 0.0;
    for (int i = 0; i <= j; ++i) sum += at(i, j) * at(i, j);
    return std::sqrt(sum);
  }

 private:
  static std::size_t index(int i) noexcept { return static_cast<std::size_t>(i); }

  int unknowns_;
  std::array<Row, static_cast<std::size_t>(Most) + 1> rows_{};
};

}  // namespace dampline

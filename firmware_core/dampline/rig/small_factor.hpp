// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>

#include "dampline/rig/columns.hpp"

namespace dampline::rig {

/// The square-root information of one model, as Information is of all columns: its number of
/// unknowns is known at run time only. The equation's right-hand side is column size().
class SmallFactor {
 public:
  static constexpr int kMax = kMaxUnknowns + 1;
  using Row = std::array<double, kMax>;
  using Vector = std::array<double, kMaxUnknowns>;

  explicit SmallFactor(int unknowns) noexcept : unknowns_{unknowns} {}

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
      for (int j = i; j <= unknowns_; ++j) {
        const double upper = r[index(j)];
        r[index(j)] = c * upper + s * row[index(j)];
        row[index(j)] = c * row[index(j)] - s * upper;
      }
    }
  }

  void merge(const SmallFactor& other) noexcept {
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
  std::array<Row, kMax> rows_{};
};

}  // namespace dampline::rig

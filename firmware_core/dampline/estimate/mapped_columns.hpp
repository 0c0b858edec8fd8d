// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "dampline/basis/columns.hpp"

namespace dampline {

/// A linear model of Q unknowns as columns of the rows: column j of the map says how regressor j is
/// made of the row's columns; the last column picks the target.
template <int Q>
using ColumnMap = Eigen::Matrix<double, kRowColumns, Q + 1>;

/// A ColumnMap without its zeros, of which it mostly consists: a mapped row costs one
/// multiplication for each entry of the map that is not zero.
template <int Q>
class MappedColumns {
 public:
  using Row = Eigen::Matrix<double, Q + 1, 1>;

  explicit MappedColumns(const ColumnMap<Q>& map) noexcept {
    std::size_t count = 0;
    for (int j = 0; j <= Q; ++j) {
      for (int i = 0; i < kRowColumns; ++i)
        if (map(i, j) != 0.0) parts_[count++] = {i, map(i, j)};
      end_[static_cast<std::size_t>(j)] = count;
    }
  }

  /// map' times row `i` of a factor.
  [[nodiscard]] Row row_of(const RowFactor& factor, int i) const noexcept {
    Row out;
    std::size_t part = 0;
    for (int j = 0; j <= Q; ++j) {
      double sum = 0.0;
      for (; part < end_[static_cast<std::size_t>(j)]; ++part)
        sum += parts_[part].share * factor.at(i, parts_[part].column);
      out[j] = sum;
    }
    return out;
  }

 private:
  struct Part {
    int column;
    double share;
  };
  static constexpr auto kColumns = static_cast<std::size_t>(Q) + 1;
  std::array<Part, kColumns* static_cast<std::size_t>(kRowColumns)> parts_;
  std::array<std::size_t, kColumns> end_{};  // of each column's parts
};

}  // namespace dampline

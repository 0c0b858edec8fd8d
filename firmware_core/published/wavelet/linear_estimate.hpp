// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "dampline/numeric/information.hpp"

namespace dampline {

/// When rows count as enough for an estimate. With less, the last estimate is held.
struct Sufficiency {
  double tolerance{1e-9};        ///< least pivot, relative to its column's norm
  double rows_per_unknown{5.0};  ///< more rows than this times the unknowns
};

/// A least-squares solution and what is known about it.
template <int Unknowns, class Scalar = double>
struct LinearEstimate {
  using Vector = Eigen::Matrix<Scalar, Unknowns, 1>;
  Vector theta = Vector::Zero();
  Vector deviation = Vector::Zero();  ///< standard deviations, for rows with independent errors
  Scalar residual_rms{0};             ///< in the unit of the right-hand side
  double rows{0.0};                   ///< a real number: forgetting makes fractions of rows
  bool valid{false};
};

/// The solution of `information` that `rows` equations made. False, and `out` left as it was, where
/// they do not suffice.
template <int Unknowns, class Scalar>
[[nodiscard]] bool solve(const Information<Unknowns + 1, Scalar>& information, double rows,
                         const Sufficiency& enough,
                         LinearEstimate<Unknowns, Scalar>& out) noexcept {
  if (!(rows > enough.rows_per_unknown * Unknowns)) return false;
  typename LinearEstimate<Unknowns, Scalar>::Vector theta;
  if (!information.solve(theta, static_cast<Scalar>(enough.tolerance))) return false;
  out.theta = theta;
  const auto freedom = static_cast<Scalar>(rows - Unknowns);
  out.residual_rms = information.residual_norm() / std::sqrt(freedom);
  const auto inverse = information.inverse();
  for (int i = 0; i < Unknowns; ++i) {
    out.deviation[i] = out.residual_rms * std::sqrt(inverse(i, i));
  }
  out.rows = rows;
  out.valid = true;
  return true;
}

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>

#include "dampline/estimate/linear_estimate.hpp"

namespace dampline {

/// Least squares over all rows so far, row by row: square-root information with or without
/// forgetting. Equal to the batch solution to rounding.
template <int Unknowns, class Scalar = double>
class RecursiveEstimate {
 public:
  using Factor = Information<Unknowns + 1, Scalar>;

  /// `memory_rows`: time constant of exponential forgetting, in rows; 0 forgets nothing.
  explicit RecursiveEstimate(double memory_rows = 0.0, const Sufficiency& enough = {}) noexcept
      : keep_{memory_rows > 0.0 ? std::exp(-1.0 / memory_rows) : 1.0}, enough_{enough} {}

  void absorb(const typename Factor::Row& row) noexcept {
    if (keep_ < 1.0) factor_.scale(static_cast<Scalar>(std::sqrt(keep_)));
    rows_ = keep_ * rows_ + 1.0;
    factor_.absorb(row);
  }

  /// Solves. False, and latest() held, where the rows do not suffice.
  [[nodiscard]] bool update() noexcept { return solve(factor_, rows_, enough_, latest_); }

  [[nodiscard]] const LinearEstimate<Unknowns, Scalar>& latest() const noexcept { return latest_; }
  [[nodiscard]] const Factor& information() const noexcept { return factor_; }
  [[nodiscard]] double rows() const noexcept { return rows_; }

 private:
  double keep_;
  Sufficiency enough_;
  Factor factor_{};
  double rows_{0.0};
  LinearEstimate<Unknowns, Scalar> latest_{};
};

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>

#include "published/wavelet/motion_rows.hpp"
#include "published/wavelet/product_table.hpp"

namespace dampline {

/// The rows of MotionRows for one degree of freedom by D8, with the regressor x x' in column
/// `Column` from the product coefficients Omega: equation 11 of Ghanem and Romeo (2001), beside
/// their equation 13, which MotionRows is. With samples for scaling coefficients the product is of
/// third order only, where the product of the samples keeps the derivative's eighth: equation 13 is
/// the better one. 127 multiplications more per sample.
template <Model M, int Column>
class ProductRows {
  static_assert(M::kDof == 1 && Column >= 0 && Column < M::kUnknowns);

 public:
  using Rows = MotionRows<D8, M>;
  using Sample = typename Rows::Sample;
  using Row = typename Rows::Row;

  /// As MotionRows::make.
  [[nodiscard]] static Result<ProductRows> make(const typename Rows::Config& config,
                                                const M& model) noexcept {
    const auto rows = Rows::make(config, model);
    if (!rows.ok()) return rows.error();
    ProductRows out;
    out.rows_ = rows.value();
    out.step_s_ = config.step_s;
    return out;
  }
  ProductRows() noexcept = default;  ///< unusable until assigned

  /// As MotionRows::push.
  [[nodiscard]] bool push(const Sample& sample, Row& row) noexcept {
    deflection_.push(sample.deflection_m[0]);
    if (!rows_.push(sample, row)) return false;
    row.regressors(0, Column) = product() / step_s_;
    return true;
  }

  /// After a gap.
  void restart() noexcept {
    rows_.restart();
    deflection_.clear();
  }

 private:
  static constexpr std::size_t kOldest =
      Rows::kLatency + D8::kReach;  // age of the stencil's first sample

  /// sum_pq Omega(p, q) s_(l+p) s_(l+q)
  [[nodiscard]] double product() const noexcept {
    double sum = 0.0;
    for (std::size_t p = 0; p < kProductD8.size(); ++p) {
      double inner = 0.0;
      for (std::size_t q = 0; q < kProductD8.size(); ++q) {
        inner += kProductD8[p][q] * deflection_.back(kOldest - q);
      }
      sum += deflection_.back(kOldest - p) * inner;
    }
    return sum;
  }

  Rows rows_{};
  RecentValues<double, kOldest + 1> deflection_{};
  double step_s_{1.0};
};

}  // namespace dampline

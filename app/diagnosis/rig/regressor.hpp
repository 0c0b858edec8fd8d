// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <vector>

#include "app/diagnosis/rig/series.hpp"
#include "app/law/regressor.hpp"

namespace dampline::app::rig {

using law::Kind;
using law::Regressor;

/// Whether the equations of a set are seen through the test function: where x'' is among them.
[[nodiscard]] bool is_filtered(const std::vector<Regressor>& columns) noexcept;

/// A column at every sample of a record, behind the path that its force passes; kInertia gives x,
/// which only rows_of differentiates.
[[nodiscard]] Eigen::VectorXd evaluate(const Regressor& column, const Series& series);

/// The force less what the columns make of it.
[[nodiscard]] Eigen::VectorXd left_of(const Series& series, const std::vector<Regressor>& columns,
                                      const Eigen::VectorXd& theta);

/// Equations: one per row, a column per regressor and the force as the last: every `stride`-th
/// sample as it is or, filtered, as an inertia needs it, everything seen through the same test
/// function (corner config.corner_hz), which also takes the second derivative; `sample` is each
/// row's centre.
struct Rows {
  Eigen::MatrixXd values;
  std::vector<Eigen::Index> sample;
};
[[nodiscard]] Rows rows_of(const std::vector<Regressor>& columns, const Series& series,
                           Eigen::Index stride, bool filtered);
[[nodiscard]] inline Rows rows_of(const std::vector<Regressor>& columns, const Series& series,
                                  Eigen::Index stride) {
  return rows_of(columns, series, stride, is_filtered(columns));
}

}  // namespace dampline::app::rig

// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "app/diagnosis/rig/rig_column.hpp"

namespace dampline::app {

/// A choice among an evidence's columns.
using ColumnSet = std::vector<Eigen::Index>;

/// A least-squares fit of some columns, judged on what was held out.
struct RigFit {
  bool ok{false};
  Eigen::VectorXd theta;
  Eigen::MatrixXd covariance;             ///< from the scatter of the blocks
  std::vector<Eigen::VectorXd> left_out;  ///< theta without each fold
  std::vector<double> record_nmse;        ///< held out, by record
  std::vector<double> block_error;        ///< held out, by block; their mean is the nmse
  double held_out_nmse{0.0};
};

/// Sums of products of all columns, block by block. Every record counts alike: its rows are divided
/// by N var f. Held out are whole records where there are three or more, otherwise blocks, dealt
/// out to five folds by a fixed shuffle, so that they keep no step with the motion.
class RigEvidence {
 public:
  RigEvidence(std::vector<RigColumn> columns, const std::vector<RigSeries>& records);

  [[nodiscard]] const std::vector<RigColumn>& columns() const { return columns_; }
  /// `ridge`: of the diagonal, for columns that overlap.
  [[nodiscard]] RigFit fit(const ColumnSet& set, double ridge) const;
  [[nodiscard]] std::size_t folds() const { return folds_; }

 private:
  struct Block {
    Eigen::MatrixXd products;
    std::size_t record;
    std::size_t fold;
  };

  std::vector<RigColumn> columns_;
  std::vector<Block> blocks_;
  std::size_t records_;
  std::size_t folds_;
};

}  // namespace dampline::app

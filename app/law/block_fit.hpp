// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

namespace dampline::app::law {

/// The residual of a part of the samples and its slopes, 0 where a sample does not count. What the
/// state at its start takes is its own.
struct Linear {
  Eigen::VectorXd left;
  Eigen::MatrixXd by_unknowns;
  Eigen::MatrixXd by_state;
};
/// What is left, and the slopes by the unknowns, when the state has taken its part.
[[nodiscard]] Linear beside_state(const Linear& part);

/// Products of the residual and of its slopes by p unknowns over some samples: [p, p], [p].
struct Sums {
  Eigen::MatrixXd products;
  Eigen::VectorXd gradient;
  double squares{0.0};
};

/// Those of all parts, beside their states; at least one.
[[nodiscard]] Sums sum_of(const std::vector<Linear>& parts);
/// Those of blocks of `length` samples, the last one shorter, behind those of `out`. `slopes`:
/// [n, p], `left`: [n].
void append_blocks(const Eigen::MatrixXd& slopes, const Eigen::VectorXd& left, Eigen::Index length,
                   std::vector<Sums>& out);

/// A fit at its least squares, by its sums over blocks in time: how certain the unknowns are.
class BlockFit {
 public:
  /// At least one block.
  explicit BlockFit(std::vector<Sums> blocks);
  /// False: the samples do not tell the unknowns apart.
  [[nodiscard]] bool ok() const;
  /// Inverse products times `right`.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  /// From the scatter of the blocks, no less than white noise makes. `freedom`: samples less what
  /// was fitted.
  [[nodiscard]] Eigen::MatrixXd covariance(double freedom) const;
  /// What each block keeps by the unknowns that four fifths of the others choose.
  [[nodiscard]] Eigen::VectorXd held_out_squares() const;

 private:
  std::vector<Sums> blocks_;
  Sums all_;
  Eigen::VectorXd size_;
  Eigen::LDLT<Eigen::MatrixXd> scaled_;
};

}  // namespace dampline::app::law

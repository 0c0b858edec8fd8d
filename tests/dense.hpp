// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>

namespace dampline::test {

/// Eigen's own answers, which ours are held against. Compiled once: each size that a test writes
/// out would cost the compiler seconds.

/// The x of least |a x - b|, by QR with pivots.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
/// a^-1, by LU with pivots.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);

}  // namespace dampline::test

// SPDX-License-Identifier: MIT
#include "tests/dense.hpp"

#include <Eigen/LU>
#include <Eigen/QR>

namespace dampline::test {

Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

Eigen::MatrixXd inverse(const Eigen::MatrixXd& a) { return a.fullPivLu().inverse(); }

}  // namespace dampline::test

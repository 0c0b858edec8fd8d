// SPDX-License-Identifier: MIT
#include "app/law/block_fit.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <utility>

namespace dampline::app::law {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

constexpr std::size_t kFolds = 5;
constexpr double kSingular = 1e-14;

}  // namespace

Linear beside_state(const Linear& part) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr{part.by_state};
  const MatrixXd q = qr.householderQ() * MatrixXd::Identity(part.by_state.rows(), qr.rank());
  Linear out;
  out.left = part.left - q * (q.transpose() * part.left);
  out.by_unknowns = part.by_unknowns - q * (q.transpose() * part.by_unknowns);
  return out;
}

Sums sum_of(const std::vector<Linear>& parts) {
  const Eigen::Index p = parts.front().by_unknowns.cols();
  Sums out{MatrixXd::Zero(p, p), VectorXd::Zero(p), 0.0};
  for (const Linear& each : parts) {
    const Linear l = beside_state(each);
    out.products += l.by_unknowns.transpose() * l.by_unknowns;
    out.gradient += l.by_unknowns.transpose() * l.left;
    out.squares += l.left.squaredNorm();
  }
  return out;
}

void append_blocks(const MatrixXd& slopes, const VectorXd& left, Eigen::Index length,
                   std::vector<Sums>& out) {
  for (Eigen::Index from = 0; from < left.size(); from += length) {
    const Eigen::Index n = std::min(length, left.size() - from);
    const auto part = slopes.middleRows(from, n);
    const auto rest = left.segment(from, n);
    out.push_back({part.transpose() * part, part.transpose() * rest, rest.squaredNorm()});
  }
}

BlockFit::BlockFit(std::vector<Sums> blocks) : blocks_{std::move(blocks)} {
  const auto p = blocks_.front().gradient.size();
  all_ = {MatrixXd::Zero(p, p), VectorXd::Zero(p), 0.0};
  for (const Sums& b : blocks_) {
    all_.products += b.products;
    all_.gradient += b.gradient;
    all_.squares += b.squares;
  }
  size_ = all_.products.diagonal().cwiseSqrt().cwiseMax(1e-300);
  scaled_.compute(size_.cwiseInverse().asDiagonal() * all_.products *
                  size_.cwiseInverse().asDiagonal());
}

bool BlockFit::ok() const {
  return scaled_.info() == Eigen::Success && scaled_.rcond() > kSingular;
}

MatrixXd BlockFit::solve(const MatrixXd& right) const {
  return size_.cwiseInverse().asDiagonal() *
         scaled_.solve(size_.cwiseInverse().asDiagonal() * right);
}

MatrixXd BlockFit::covariance(double freedom) const {
  const auto p = size_.size();
  MatrixXd scatter = MatrixXd::Zero(p, p);
  for (const Sums& b : blocks_) scatter += b.gradient * b.gradient.transpose();
  const MatrixXd inverse = solve(MatrixXd::Identity(p, p));
  const auto count = static_cast<double>(blocks_.size());
  const MatrixXd out =
      count / std::max(count - static_cast<double>(p), 1.0) * inverse * scatter * inverse;
  const MatrixXd white = all_.squares / std::max(freedom, 1.0) * inverse;
  const VectorXd widen =
      (white.diagonal().array() / out.diagonal().array().max(1e-300)).sqrt().max(1.0);
  return widen.asDiagonal() * out * widen.asDiagonal();
}

VectorXd BlockFit::held_out_squares() const {
  VectorXd held_out{static_cast<Eigen::Index>(blocks_.size())};
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    MatrixXd products = all_.products;
    VectorXd gradient = all_.gradient;
    for (std::size_t b = fold; b < blocks_.size(); b += kFolds) {
      products -= blocks_[b].products;
      gradient -= blocks_[b].gradient;
    }
    const VectorXd by = -products.ldlt().solve(gradient);
    for (std::size_t b = fold; b < blocks_.size(); b += kFolds)
      held_out[static_cast<Eigen::Index>(b)] =
          blocks_[b].squares + 2.0 * by.dot(blocks_[b].gradient) + by.dot(blocks_[b].products * by);
  }
  return held_out;
}

}  // namespace dampline::app::law

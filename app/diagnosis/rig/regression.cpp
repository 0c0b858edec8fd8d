// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/regression.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "app/beside.hpp"
#include "dampline/numeric/mean_t.hpp"
#include "dampline/rig/config.hpp"

namespace dampline::app::rig {
namespace {

constexpr std::size_t kBlocksOfAll = 60;
constexpr std::size_t kFewestRecords = 3;  // for whole records to be held out
constexpr std::size_t kFolds = 5;
constexpr double kRowsPerSecond = 256.0;  // enough for what is not filtered
constexpr double kDependent = 1e-11;

/// A fixed shuffle: equal numbers of blocks in each fold, in no regular order.
std::vector<std::size_t> dealt_folds(std::size_t blocks) {
  std::vector<std::size_t> out(blocks);
  for (std::size_t i = 0; i < blocks; ++i) out[i] = i % kFolds;
  std::uint32_t state = 12345;
  for (std::size_t i = blocks; i-- > 1;) {
    state = state * 1664525U + 1013904223U;
    std::swap(out[i], out[(state >> 8U) % (i + 1)]);
  }
  return out;
}

Eigen::Index stride_of(const Series& series, bool filtered) {
  if (filtered) return std::max(1, core::half_support_samples(series.config) / 8);
  const double samples = 1.0 / (series.interval_s * kRowsPerSecond);
  return std::max<Eigen::Index>(1, static_cast<Eigen::Index>(samples));
}

/// Columns of very different units on one scale.
Eigen::VectorXd scale_of(const Eigen::MatrixXd& normal) {
  Eigen::VectorXd scale = normal.diagonal();
  for (double& s : scale) s = s > 0.0 ? 1.0 / std::sqrt(s) : 1.0;
  return scale;
}

bool solve(const Eigen::MatrixXd& sum, double ridge, Eigen::VectorXd& theta,
           Eigen::MatrixXd* inverse = nullptr) {
  const Eigen::Index n = sum.rows() - 1;
  const Eigen::VectorXd scale = scale_of(sum.topLeftCorner(n, n));
  Eigen::MatrixXd normal = scale.asDiagonal() * sum.topLeftCorner(n, n) * scale.asDiagonal();
  normal.diagonal().array() += std::max(ridge, kDependent);
  const Eigen::LLT<Eigen::MatrixXd> factor{normal};
  if (factor.info() != Eigen::Success) return false;
  theta = scale.asDiagonal() * factor.solve(scale.asDiagonal() * sum.col(n).head(n));
  if (inverse != nullptr)
    *inverse =
        scale.asDiagonal() * factor.solve(Eigen::MatrixXd::Identity(n, n)) * scale.asDiagonal();
  return theta.allFinite();
}

double error_of(const Eigen::MatrixXd& sum, const Eigen::VectorXd& theta) {
  const Eigen::Index n = theta.size();
  return sum(n, n) - 2.0 * theta.dot(sum.col(n).head(n)) +
         theta.dot(sum.topLeftCorner(n, n) * theta);
}

Eigen::MatrixXd part_of(const Eigen::MatrixXd& products, const ColumnSet& set) {
  const auto n = static_cast<Eigen::Index>(set.size());
  const auto source = [&](Eigen::Index i) {
    return i < n ? set[static_cast<std::size_t>(i)] : products.rows() - 1;
  };
  Eigen::MatrixXd out{n + 1, n + 1};
  for (Eigen::Index i = 0; i <= n; ++i)
    for (Eigen::Index j = 0; j <= n; ++j) out(i, j) = products(source(i), source(j));
  return out;
}

}  // namespace

std::vector<Equations> equations_of(const std::vector<Regressor>& columns,
                                    const std::vector<Series>& records, bool filtered) {
  std::vector<Equations> out;
  for (const Series& record : records) {
    Rows rows = rows_of(columns, record, stride_of(record, filtered), filtered);
    std::vector<Eigen::Index> moving;
    std::vector<Eigen::Index> kept;
    for (std::size_t i = 0; i < rows.sample.size(); ++i) {
      const double why = record.why_left_out(rows.sample[i]);
      if (why != Series::kRest) moving.push_back(static_cast<Eigen::Index>(i));
      if (why == 0.0) kept.push_back(static_cast<Eigen::Index>(i));
    }
    const Eigen::VectorXd force = rows.values.rightCols<1>()(moving);
    const double weight = 1.0 / (force.array() - force.mean()).square().sum();
    if (kept.size() == rows.sample.size()) {
      out.push_back({std::move(rows.values), std::move(rows.sample), weight});
      continue;
    }
    out.push_back({rows.values(kept, Eigen::all), {}, weight});
    for (const Eigen::Index i : kept)
      out.back().sample.push_back(rows.sample[static_cast<std::size_t>(i)]);
  }
  return out;
}

Regression::Regression(const std::vector<Equations>& records) : records_{records.size()} {
  const std::size_t parts = std::max<std::size_t>(3, kBlocksOfAll / records.size());
  blocks_.resize(records.size() * parts);
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Eigen::MatrixXd& values = records[r].values;
    each_of_values(values.size(), parts, [&](std::size_t p) {
      const auto first_row_of = [&](std::size_t part) {
        return values.rows() * static_cast<Eigen::Index>(part) / static_cast<Eigen::Index>(parts);
      };
      const auto block = values.middleRows(first_row_of(p), first_row_of(p + 1) - first_row_of(p));
      Block out{Eigen::MatrixXd::Zero(block.cols(), block.cols()), r, r, 2 * p < parts};
      out.products.selfadjointView<Eigen::Lower>().rankUpdate(block.transpose(), records[r].weight);
      out.products.triangularView<Eigen::StrictlyUpper>() = out.products.transpose();
      blocks_[r * parts + p] = std::move(out);
    });
  }
  folds_ = records_;
  if (records_ >= kFewestRecords) return;
  folds_ = kFolds;
  const std::vector<std::size_t> fold = dealt_folds(blocks_.size());
  for (std::size_t b = 0; b < blocks_.size(); ++b) blocks_[b].fold = fold[b];
}

Fit Regression::fit(const ColumnSet& set, double ridge) const {
  Fit out;
  std::vector<Eigen::MatrixXd> parts;
  const auto n = static_cast<Eigen::Index>(set.size());
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::MatrixXd first_half = total;
  std::vector<Eigen::MatrixXd> fold(folds_, total);
  for (const Block& block : blocks_) {
    parts.push_back(part_of(block.products, set));
    fold[block.fold] += parts.back();
    total += parts.back();
    if (block.is_first_half) first_half += parts.back();
  }
  Eigen::MatrixXd inverse;
  if (!solve(total, ridge, out.theta, &inverse)) return out;
  out.left_out.resize(folds_);
  for (std::size_t f = 0; f < folds_; ++f)
    if (!solve(total - fold[f], ridge, out.left_out[f])) return out;
  out.record_nmse.assign(records_, 0.0);
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const double error = error_of(parts[b], out.left_out[blocks_[b].fold]);
    out.record_nmse[blocks_[b].record] += error;
    out.block_error.push_back(error * static_cast<double>(blocks_.size()) /
                              static_cast<double>(records_));
    const Eigen::VectorXd score =
        parts[b].col(n).head(n) - parts[b].topLeftCorner(n, n) * out.theta;
    meat += score * score.transpose();
  }
  for (const double nmse : out.record_nmse)
    out.held_out_nmse += nmse / static_cast<double>(records_);
  // The blocks' own fit has made their scores too small by as many as there are coefficients.
  const auto blocks = static_cast<double>(blocks_.size());
  const double free = std::max(blocks - static_cast<double>(n), 0.25 * blocks);
  out.covariance = blocks / free * inverse * meat * inverse;
  Eigen::VectorXd second;
  if (solve(first_half, ridge, out.half_difference) && solve(total - first_half, ridge, second))
    out.half_difference -= second;
  else
    out.half_difference = Eigen::VectorXd::Zero(n);
  out.ok = true;
  return out;
}

double block_t(const Fit& before, const Fit& after) {
  MeanT gain;
  for (std::size_t b = 0; b < before.block_error.size(); ++b)
    gain.add(before.block_error[b] - after.block_error[b]);
  return gain.t();
}

double jackknife_std(const std::vector<double>& left_out) {
  const auto n = static_cast<double>(left_out.size());
  double mean = 0.0;
  double squares = 0.0;
  for (const double x : left_out) mean += x / n;
  for (const double x : left_out) squares += (x - mean) * (x - mean);
  return std::sqrt((n - 1.0) / n * squares);
}

}  // namespace dampline::app::rig

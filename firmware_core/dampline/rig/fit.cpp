// SPDX-License-Identifier: MIT
#include "dampline/rig/fit.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::rig {
namespace {

constexpr int kSegments = static_cast<int>(kCurveSegments);

using Vector = ModelInformation::Vector;
using Scores = std::array<Vector, BlockStore::kMaxBlocks>;

std::size_t as_size(int i) noexcept { return static_cast<std::size_t>(i); }

ModelInformation::Row mapped(const Model& model, const Block::Row& row) noexcept {
  ModelInformation::Row out{};
  for (int j = 0; j < model.size(); ++j) out[as_size(j)] = model.value(j, row);
  out[as_size(model.size())] = row[column::kForce];
  return out;
}

double residual(const ModelInformation::Row& row, const Vector& theta, int size) noexcept {
  double out = row[as_size(size)];
  for (int j = 0; j < size; ++j) out -= row[as_size(j)] * theta[as_size(j)];
  return out;
}

bool empty(const Block& block) noexcept { return !(block.column_norm(column::kOne) > 0.0); }

/// One factor per fold and their sum.
struct Factors {
  explicit Factors(int size) noexcept
      : all{size},
        folds{ModelInformation{size}, ModelInformation{size}, ModelInformation{size},
              ModelInformation{size}, ModelInformation{size}} {}
  ModelInformation all;
  std::array<ModelInformation, kFolds> folds;
};

Factors gather(const BlockStore& store, const Model& model) noexcept {
  Factors out{model.size()};
  for (std::size_t b = 0; b < store.size(); ++b) {
    if (empty(store.block(b))) continue;
    for (int i = 0; i < column::kCount; ++i)
      out.folds[fold_of(b)].absorb(mapped(model, store.block(b).row(i)));
  }
  for (const ModelInformation& fold : out.folds) out.all.merge(fold);
  return out;
}

/// Solves without each fold. False when a fold is needed to determine an unknown.
bool solve_folds(const Factors& factors, Solution& out) noexcept {
  for (std::size_t f = 0; f < kFolds; ++f) {
    ModelInformation rest{factors.all.size()};
    for (std::size_t g = 0; g < kFolds; ++g)
      if (g != f) rest.merge(factors.folds[g]);
    if (rest.undetermined() >= 0) return false;
    out.theta_without[f] = rest.solve();
  }
  return true;
}

/// Sums over rows, each in newtons squared.
struct Sums {
  double rows{0.0};
  double variance{0.0};  ///< of the force about its mean
  double fitted{0.0};
  double held_out{0.0};
};

Sums sums_of(const BlockStore& store, const Solution& solution) noexcept {
  Sums out;
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t b = 0; b < store.size(); ++b) {
    for (int i = 0; i < column::kCount; ++i) {
      const Block::Row row = store.block(b).row(i);
      const ModelInformation::Row small = mapped(solution.model, row);
      const int size = solution.model.size();
      const double fitted = residual(small, solution.theta, size);
      const double held_out = residual(small, solution.theta_without[fold_of(b)], size);
      out.fitted += fitted * fitted;
      out.held_out += held_out * held_out;
      out.rows += row[column::kOne] * row[column::kOne];
      sum += row[column::kOne] * row[column::kForce];
      squares += row[column::kForce] * row[column::kForce];
    }
  }
  out.variance = squares - sum * sum / out.rows;
  return out;
}

/// X'(t - X theta) of each block that holds rows, in time order. Returns how many.
std::size_t scores(const BlockStore& store, const Solution& solution, Scores& out) noexcept {
  std::size_t count = 0;
  const int size = solution.model.size();
  for (std::size_t b = 0; b < store.size(); ++b) {
    if (empty(store.block(b))) continue;
    Vector& score = out[count++];
    score.fill(0.0);
    for (int i = 0; i < column::kCount; ++i) {
      const ModelInformation::Row row = mapped(solution.model, store.block(b).row(i));
      const double left = residual(row, solution.theta, size);
      for (int j = 0; j < size; ++j) score[as_size(j)] += row[as_size(j)] * left;
    }
  }
  return count;
}

/// Adds weight times sum over b of influence_b influence_{b-lag}' and its transpose.
void add_lag(const Scores& influence, std::size_t count, std::size_t lag, double weight, int size,
             Solution::Matrix& out) noexcept {
  for (std::size_t b = lag; b < count; ++b)
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) {
        const double a = influence[b][as_size(i)] * influence[b - lag][as_size(j)];
        out(i, j) += 0.5 * weight * a;
        out(j, i) += 0.5 * weight * a;
      }
}

void set_covariance(const BlockStore& store, const ModelInformation& all, Solution& out) noexcept {
  Scores influence;  // of each block on theta: (X'X)^-1 score
  const std::size_t count = scores(store, out, influence);
  for (std::size_t b = 0; b < count; ++b) influence[b] = all.solve_normal(influence[b]);
  const auto blocks = static_cast<double>(count);
  const auto lags = static_cast<std::size_t>(4.0 * std::pow(blocks / 100.0, 2.0 / 9.0));
  add_lag(influence, count, 0, 1.0, out.model.size(), out.covariance);
  for (std::size_t lag = 1; lag <= lags; ++lag) {
    const double weight = 1.0 - static_cast<double>(lag) / static_cast<double>(lags + 1);
    add_lag(influence, count, lag, 2.0 * weight, out.model.size(), out.covariance);
  }
  // Few blocks: degrees of freedom, and the score's own uncertainty (fitted on simulated trucks).
  const double short_record = 1.0 + 2.5 / std::max(blocks - 3.0, 1.0);
  const double freedom = blocks / std::max(blocks - out.model.size(), 1.0);
  out.covariance *= short_record * short_record * freedom;
  out.blocks = static_cast<std::uint32_t>(count);
}

}  // namespace

Model::Model(const Terms& terms) noexcept {
  add_linear(terms);
  add_coulomb(terms.coulomb);
  add_viscous(terms.viscous);
  if (terms.offset) add(Parameter::kOffset)[column::kOne] = 1.0;
}

Model Model::curve(const Terms& terms) noexcept {
  Model model;
  model.add_linear(terms);
  model.add_coulomb(Branches::kSeparate);
  for (int i = 0; i < 2 * kSegments; ++i)
    model.add(Parameter::kSlope)[column::kRampPositive + i] = 1.0;
  return model;
}

Model::Column& Model::add(Parameter id) noexcept {
  const std::size_t j = as_size(size_);
  id_[j] = id;
  columns_[j].setZero();
  ++size_;
  return columns_[j];
}

void Model::add_linear(const Terms& terms) noexcept {
  if (terms.inertia) add(Parameter::kMovingMass)[column::kInertia] = 1.0;
  if (terms.stiffness) add(Parameter::kStiffness)[column::kStiffness] = 1.0;
}

void Model::add_viscous(Branches branches) noexcept {
  if (branches == Branches::kCommon) add(Parameter::kViscous)[column::kViscous] = 1.0;
  if (branches != Branches::kSeparate) return;
  add(Parameter::kViscousPositive).segment<kSegments>(column::kRampPositive).setOnes();
  add(Parameter::kViscousNegative).segment<kSegments>(column::kRampNegative).setOnes();
}

/// The sign s is the expected one, so the share of time with v > 0 is (1 + s) / 2.
void Model::add_coulomb(Branches branches) noexcept {
  if (branches == Branches::kCommon) add(Parameter::kCoulomb)[column::kSign] = 1.0;
  if (branches != Branches::kSeparate) return;
  Column& positive = add(Parameter::kCoulombPositive);
  positive[column::kSign] = 0.5;
  positive[column::kOne] = 0.5;
  Column& negative = add(Parameter::kCoulombNegative);
  negative[column::kSign] = 0.5;
  negative[column::kOne] = -0.5;
}

void Model::remove(int j) noexcept {
  --size_;
  for (int i = j; i < size_; ++i) {
    id_[as_size(i)] = id_[as_size(i + 1)];
    columns_[as_size(i)] = columns_[as_size(i + 1)];
  }
}

double Solution::std_of(const ModelInformation::Vector& weights) const noexcept {
  double variance = 0.0;
  for (int i = 0; i < model.size(); ++i)
    for (int j = 0; j < model.size(); ++j)
      variance += weights[as_size(i)] * covariance(i, j) * weights[as_size(j)];
  return std::sqrt(std::max(variance, 0.0));
}

Solution solve(const BlockStore& store, const Model& model) noexcept {
  Solution out;
  out.model = model;
  Factors factors = gather(store, out.model);
  for (int bad = factors.all.undetermined(); bad >= 0; bad = factors.all.undetermined()) {
    out.model.remove(bad);
    if (out.model.size() == 0) return out;
    factors = gather(store, out.model);
  }
  if (!solve_folds(factors, out)) return out;
  out.theta = factors.all.solve();
  set_covariance(store, factors.all, out);
  const Sums sums = sums_of(store, out);
  if (!(sums.variance > 0.0) || static_cast<int>(out.blocks) <= out.model.size()) return out;
  out.nmse = sums.fitted / sums.variance;
  out.held_out_nmse = sums.held_out / sums.variance;
  out.residual_n = std::sqrt(sums.fitted / sums.rows);
  out.valid = true;
  return out;
}

}  // namespace dampline::rig

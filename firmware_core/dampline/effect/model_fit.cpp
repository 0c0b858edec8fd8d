// SPDX-License-Identifier: MIT
#include "dampline/effect/model_fit.hpp"

#include <algorithm>
#include <cmath>

#include "dampline/numeric/cholesky.hpp"

namespace dampline::effect {
namespace {

constexpr double kFewestRows = 100.0;

constexpr std::size_t kFolds = 5;
constexpr double kDependent = 1e-10;

/// Normal equations of the first `count` columns, the last of them the target, by Cholesky with
/// pivots checked; false when the data do not determine an unknown.
template <class Small, class Vector>
bool solve(const Small& normal, int count, Vector& theta, Small* inverse = nullptr) noexcept {
  const int n = count - 1;
  Cholesky<Vector::RowsAtCompileTime> cholesky;
  if (!cholesky.factor(normal, n, kDependent)) return false;
  theta.setZero();
  for (int i = 0; i < n; ++i) theta[i] = normal(i, n);
  cholesky.solve(theta);
  if (inverse == nullptr) return true;
  inverse->setZero();
  for (int j = 0; j < n; ++j) {
    Vector unit = Vector::Zero();
    unit[j] = 1.0;
    cholesky.solve(unit);
    for (int i = 0; i < n; ++i) (*inverse)(i, j) = unit[i];
  }
  return true;
}

/// |A theta - t|^2 from the normal equations.
template <class Small, class Vector>
double error_of(const Small& normal, int count, const Vector& theta) noexcept {
  const int n = count - 1;
  double sum = normal(n, n);
  for (int i = 0; i < n; ++i) {
    double row = -2.0 * normal(i, n);
    for (int j = 0; j < n; ++j) row += normal(i, j) * theta[j];
    sum += theta[i] * row;
  }
  return sum;
}

std::size_t below(std::size_t i) noexcept { return i > 0 ? i - 1 : i; }
std::size_t above(std::size_t i) noexcept { return i + 1 < kWidths ? i + 1 : i; }
int sign_column(std::size_t i) noexcept { return kSign + static_cast<int>(i); }

}  // namespace

bool Evidence::load(const GramStore& store) noexcept {
  count = store.count();
  rows.fill(0.0);
  ScaleWeights start{};
  bool any = false;
  for (std::size_t s = 0; s < kScales; ++s) {
    scale[s].clear();
    for (std::size_t e = 0; e < count; ++e) {
      scale[s].add(store.entry(e).gram[s]);
      rows[s] += store.entry(e).rows[s];
    }
    const double target = scale[s].at(kTarget, kTarget);
    if (rows[s] < kFewestRows || !(target > 0.0)) continue;
    start[s] = rows[s] / target;
    any = true;
  }
  if (any) weigh(store, start);
  return any;
}

void Evidence::weigh(const GramStore& store, const ScaleWeights& weights) noexcept {
  weight = weights;
  total.clear();
  for (std::size_t e = 0; e < count; ++e) {
    entry[e].clear();
    for (std::size_t s = 0; s < kScales; ++s) {
      if (weight[s] > 0.0) entry[e].add(store.entry(e).gram[s], weight[s]);
    }
    total.add(entry[e]);
  }
}

void ModelFitter::project(const Gram& gram, const Terms& terms, int count,
                          Small& out) const noexcept {
  for (int i = 0; i < count; ++i) {
    for (int j = i; j < count; ++j) {
      const Regressor& a = terms[static_cast<std::size_t>(i)];
      const Regressor& b = terms[static_cast<std::size_t>(j)];
      double sum = 0.0;
      for (std::size_t p = 0; p < a.count; ++p) {
        for (std::size_t q = 0; q < b.count; ++q) {
          sum += a.weight[p] * b.weight[q] * gram.at(a.column[p], b.column[q]);
        }
      }
      out(i, j) = out(j, i) = sum;
    }
  }
}

int ModelFitter::columns(const Model& model, std::size_t i, Terms& terms) noexcept {
  int count = ModelFit::kFirstEffect;
  terms[ModelFit::kCoulomb] = Regressor::of(sign_column(i));
  terms[ModelFit::kStiffness] = stiffness_regressor();
  terms[ModelFit::kWidthChange] =
      Regressor::of(sign_column(above(i))).plus(sign_column(below(i)), -1.0);
  for (std::size_t e = 0; e < model.count; ++e) {
    for (std::size_t r = 0; r < model.effect[e].count; ++r) {
      terms[static_cast<std::size_t>(count++)] = model.effect[e].regressor[r];
    }
  }
  terms[static_cast<std::size_t>(count++)] = Regressor::of(kTarget);
  return count;
}

/// The width that fits best as it is, as the estimate chooses it: with its change among the
/// unknowns, distant ones would mimic other laws.
bool ModelFitter::choose_width(const Model& model, std::size_t& best) const noexcept {
  Terms terms{};
  bool found = false;
  double least = 0.0;
  for (std::size_t i = 0; i < kWidths; ++i) {
    const int count = columns(model, i, terms) - 1;
    std::copy(terms.begin() + ModelFit::kWidthChange + 1, terms.end(),
              terms.begin() + ModelFit::kWidthChange);
    Small normal;
    project(evidence_->total, terms, count, normal);
    ModelFit::Vector theta;
    if (!solve(normal, count, theta)) continue;
    const double error = error_of(normal, count, theta);
    if (found && error >= least) continue;
    found = true;
    least = error;
    best = i;
  }
  return found;
}

ModelFit ModelFitter::fit(const Model& model) noexcept {
  Terms terms{};
  ModelFit out;
  if (!choose_width(model, out.width_index)) return out;
  const std::size_t i = out.width_index;
  const int count = columns(model, i, terms);
  project(evidence_->total, terms, count, total_);
  out.ok = solve(total_, count, out.theta);
  if (!out.ok) return out;
  out.terms = count - 1;
  const double shift = out.theta[ModelFit::kWidthChange] / out.theta[ModelFit::kCoulomb];
  out.width_mps = kWidthMps[i] + shift * (kWidthMps[above(i)] - kWidthMps[below(i)]);
  out.nmse = error_of(total_, count, out.theta) / total_(count - 1, count - 1);
  for (std::size_t e = 0; e < evidence_->count; ++e) {
    project(evidence_->entry[e], terms, count, entry_[e]);
  }
  judge(out);
  spread(out);
  return out;
}

double ModelFitter::nmse_of(const Model& model, const ModelFit& fit) const noexcept {
  Terms terms{};
  const int count = columns(model, fit.width_index, terms);
  Small normal;
  project(evidence_->total, terms, count, normal);
  const double target = normal(count - 1, count - 1);
  return target > 0.0 ? error_of(normal, count, fit.theta) / target : 0.0;
}

double ModelFitter::force(const Model& model, const ModelFit& fit, const Row& row) noexcept {
  Terms terms{};
  const int count = columns(model, fit.width_index, terms);
  double sum = 0.0;
  for (int i = 0; i + 1 < count; ++i) {
    const Regressor& r = terms[static_cast<std::size_t>(i)];
    for (std::size_t p = 0; p < r.count; ++p) sum += fit.theta[i] * r.weight[p] * row[r.column[p]];
  }
  return sum;
}

ScaleWeights ModelFitter::weights_of(const Model& model, const ModelFit& fit) const noexcept {
  Terms terms{};
  const int count = columns(model, fit.width_index, terms);
  ScaleWeights out{};
  for (std::size_t s = 0; s < kScales; ++s) {
    if (!(evidence_->weight[s] > 0.0)) continue;
    Small normal;
    project(evidence_->scale[s], terms, count, normal);
    const double error = error_of(normal, count, fit.theta);
    if (error > 0.0) out[s] = evidence_->rows[s] / error;
  }
  return out;
}

void ModelFitter::judge(ModelFit& fit) noexcept {
  const int count = fit.terms + 1;
  const double target = total_(fit.terms, fit.terms);
  const std::size_t entries = evidence_->count;
  fit.held_out_nmse = 0.0;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    Small rest = Small::Zero();
    for (std::size_t e = 0; e < entries; ++e) {
      const std::size_t place = e % kFolds;
      const bool near =
          place == fold || (place + 1) % kFolds == fold || (place + kFolds - 1) % kFolds == fold;
      if (!near) rest += entry_[e];
    }
    ModelFit::Vector theta;
    if (!solve(rest, count, theta)) theta = fit.theta;
    for (std::size_t e = fold; e < entries; e += kFolds) {
      fit.held_out_error[e] = error_of(entry_[e], count, theta) / target;
      fit.held_out_nmse += fit.held_out_error[e];
    }
  }
}

/// From the scores of the entries, as the base estimate's.
void ModelFitter::spread(ModelFit& fit) noexcept {
  Small inverse;
  ModelFit::Vector theta;
  if (!solve(total_, fit.terms + 1, theta, &inverse)) return;
  ScoreScatter<kMostTerms> scatter;
  for (std::size_t e = 0; e < evidence_->count; ++e) {
    ModelFit::Vector score = ModelFit::Vector::Zero();
    for (int i = 0; i < fit.terms; ++i) {
      score[i] = entry_[e](i, fit.terms);
      for (int j = 0; j < fit.terms; ++j) score[i] -= entry_[e](i, j) * fit.theta[j];
    }
    scatter.add(score, fit.terms);
  }
  fit.covariance = scatter.covariance(inverse.template topLeftCorner<kMostTerms, kMostTerms>());
}

}  // namespace dampline::effect

// SPDX-License-Identifier: MIT
#include "app/wavelet/equations.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "app/error.hpp"
#include "app/wavelet/deflections.hpp"

namespace dampline::app::wavelet {
namespace {

bool stands(const std::vector<RunTimeTerm>& terms, const RunTimeTerm& term) {
  return std::find(terms.begin(), terms.end(), term) != terms.end();
}

double largest_deflection_m(const Measured& measured) {
  double largest = 0.0;
  for (const auto& deflections : measured.deflection_m)
    for (const double x : deflections) largest = std::max(largest, std::abs(x));
  return largest;
}

}  // namespace

template <int Dof>
Equations<Dof>::Equations(const Measured& measured, const Question& question)
    : measured_{measured},
      wavelet_{question.wavelet},
      level_{question.level},
      mass_known_{!question.mass_kg.empty() || measured.from_accelerations} {
  config_.step_s = measured.step_s;
  config_.mass_kg.fill(1.0);
  for (std::size_t d = 0; d < question.mass_kg.size(); ++d)
    config_.mass_kg[d] = question.mass_kg[d];
  add_columns(question);
  if (question.compares) add_candidates(question);
  std::vector<typename TermsModel<Dof>::Placed> placed;
  for (const ColumnOf& c : columns_)
    if (c.term.kind != TermKind::kInertia) placed.push_back({c.term, c.element});
  model_ = TermsModel<Dof>{placed, largest_deflection_m(measured)};
  watch(question);
}

template <int Dof>
void Equations<Dof>::add_columns(const Question& question) {
  int next = 0;
  for (std::size_t e = 0; e < question.terms.size(); ++e) {
    for (const RunTimeTerm& term : question.terms[e]) {
      const bool inertia = term.kind == TermKind::kInertia;
      const int column = inertia ? TermsModel<Dof>::kTerms + static_cast<int>(e) : next++;
      columns_.push_back({column, static_cast<int>(e), term});
      const Sensitivities by = sensitivities_of(term);
      for (std::size_t i = 0; i < by.count; ++i)
        if (!stands(sensitivities_, by.terms[i])) sensitivities_.push_back(by.terms[i]);
    }
  }
  if (next > TermsModel<Dof>::kTerms)
    throw UsageError{
        fmt::format("--terms: found {} terms, expected at most {}", next, TermsModel<Dof>::kTerms)};
}

template <int Dof>
void Equations<Dof>::add_candidates(const Question& question) {
  int next = 0;
  for (const ColumnOf& c : columns_)
    if (c.term.kind != TermKind::kInertia) next = std::max(next, c.column + 1);
  for (std::size_t e = 0; e < question.terms.size(); ++e)
    for (const RunTimeTerm& term : usual_terms())
      if (next < TermsModel<Dof>::kTerms && !stands(question.terms[e], term))
        columns_.push_back({next++, static_cast<int>(e), term, false});
}

template <int Dof>
void Equations<Dof>::watch(const Question& question) {
  for (const ColumnOf& c : columns_) {
    if (!c.asked || !question.gated) continue;
    gated_ = gated_ || c.term.kink_at_rest() || c.term.kink_at_centre();
    if (c.term.kink_at_centre()) model_.watch_centre(c.element);
  }
}

template <int Dof>
TermMask<TermsModel<Dof>::kUnknowns> Equations<Dof>::asked() const noexcept {
  TermMask<TermsModel<Dof>::kUnknowns> out{};
  for (const ColumnOf& c : columns_)
    if (c.asked) out[static_cast<std::size_t>(c.column)] = true;
  return out;
}

template <int Dof>
void Equations<Dof>::finish_row(Row& row) const {
  add_inertia(row);
  if (mass_known_) return;
  for (std::size_t d = 0; d < static_cast<std::size_t>(Dof); ++d) {
    row.target_n[d] += config_.mass_kg[d] * row.accel_mps2[d];
    row.accel_mps2[d] = row.target_n[d];
  }
}

template <int Dof>
void Equations<Dof>::for_each(const Use& use) const {
  const auto stream = make_row_stream<Dof>(wavelet_, level_, config_, model_);
  std::vector<Timed> block;
  Row row;
  for (std::size_t s = 0; s < measured_.stretches.size(); ++s) {
    stream->restart();
    for (std::size_t i = measured_.stretches[s].begin; i < measured_.stretches[s].end; ++i) {
      MotionSample<Dof> sample;
      for (std::size_t d = 0; d < static_cast<std::size_t>(Dof); ++d) {
        sample.deflection_m[d] = measured_.deflection_m[d][i];
        sample.force_n[d] =
            measured_.force_n[d][i] * (measured_.from_accelerations ? config_.mass_kg[d] : 1.0);
      }
      if (!stream->push(sample, row) || (gated_ && !row.usable)) continue;
      const auto at = static_cast<std::size_t>(row.sample);
      finish_row(row);
      if (!measured_.from_accelerations)
        use(row, measured_.time_s[at]);
      else if (at >= measured_.blocks[s].begin && at < measured_.blocks[s].end)
        block.push_back({row, measured_.time_s[at]});
    }
    project(block);
    for (const Timed& timed : block) use(timed.row, timed.time_s);
    block.clear();
  }
}

template <int Dof>
void Equations<Dof>::project(std::vector<Timed>& rows) const {
  const std::size_t nuisance = static_cast<std::size_t>(kSlow) * (1 + Dof * sensitivities_.size());
  if (rows.size() < 2 * nuisance) {
    rows.clear();
    return;
  }
  for (int d = 0; d < Dof; ++d) project_equation(rows, d);
}

/// What remains of each column when the slow polynomials, and the sensitivities times these, have
/// been fitted to it and taken away.
template <int Dof>
void Equations<Dof>::project_equation(std::vector<Timed>& rows, int d) const {
  using Index = Eigen::Index;
  const auto count = static_cast<Index>(rows.size());
  const auto elements = static_cast<Index>(Dof);
  const auto factors = static_cast<Index>(sensitivities_.size());
  Eigen::MatrixXd slow{count, kSlow * (1 + elements * factors)};
  constexpr int kUnknowns = TermsModel<Dof>::kUnknowns;
  Eigen::MatrixXd values{count, kUnknowns + 2};
  const auto at = static_cast<std::size_t>(d);
  const double first_s = rows.front().time_s;
  const double length_s = rows.back().time_s - first_s;
  for (Index i = 0; i < count; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)].row;
    const double u = 2.0 * (rows[static_cast<std::size_t>(i)].time_s - first_s) / length_s - 1.0;
    Eigen::Matrix<double, 1, kSlow> p;
    for (int j = 0; j < kSlow; ++j) p[j] = std::cos(j * std::acos(std::clamp(u, -1.0, 1.0)));
    slow.row(i).head(kSlow) = p;
    Index column = kSlow;
    for (Index e = 0; e < elements; ++e) {
      const double x =
          row.deflection_m[static_cast<std::size_t>(e)] - (e > 0 ? row.deflection_m[0] : 0.0);
      const double v =
          row.velocity_mps[static_cast<std::size_t>(e)] - (e > 0 ? row.velocity_mps[0] : 0.0);
      for (const RunTimeTerm& factor : sensitivities_) {
        slow.row(i).segment(column, kSlow) = factor(x, v) * p;
        column += kSlow;
      }
    }
    values.row(i).head(kUnknowns) = row.regressors.row(d);
    values(i, kUnknowns) = row.target_n[at];
    values(i, kUnknowns + 1) = row.accel_mps2[at];
  }
  for (Index j = 0; j < slow.cols(); ++j)
    if (const double norm = slow.col(j).norm(); norm > 0.0) slow.col(j) /= norm;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> basis{slow};
  Eigen::MatrixXd turned = basis.householderQ().transpose() * values;
  turned.topRows(basis.rank()).setZero();
  values = basis.householderQ() * turned;
  for (Index i = 0; i < count; ++i) {
    Row& row = rows[static_cast<std::size_t>(i)].row;
    row.regressors.row(d) = values.row(i).head(kUnknowns);
    row.target_n[at] = values(i, kUnknowns);
    row.accel_mps2[at] = values(i, kUnknowns + 1);
  }
}

template class Equations<1>;
template class Equations<2>;

}  // namespace dampline::app::wavelet

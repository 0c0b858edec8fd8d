// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

#include "dampline/basis/columns.hpp"
#include "dampline/estimate/grouped_store.hpp"
#include "dampline/estimate/statistics.hpp"
#include "dampline/numeric/cholesky.hpp"

namespace dampline {

/// A linear model of Q unknowns as columns of the rows: column j of the map says how regressor j is
/// made of the row's columns; the last column picks the target.
template <int Q>
using ColumnMap = Eigen::Matrix<double, kRowColumns, Q + 1>;

/// A ColumnMap without its zeros, of which it mostly consists: a mapped row costs one
/// multiplication for each entry of the map that is not zero.
template <int Q>
class MappedColumns {
 public:
  using Row = Eigen::Matrix<double, Q + 1, 1>;

  explicit MappedColumns(const ColumnMap<Q>& map) noexcept {
    std::size_t count = 0;
    for (int j = 0; j <= Q; ++j) {
      for (int i = 0; i < kRowColumns; ++i)
        if (map(i, j) != 0.0) parts_[count++] = {i, map(i, j)};
      end_[static_cast<std::size_t>(j)] = count;
    }
  }

  /// map' times row `i` of a factor.
  template <class Factor>
  [[nodiscard]] Row row_of(const Factor& factor, int i) const noexcept {
    Row out;
    std::size_t part = 0;
    for (int j = 0; j <= Q; ++j) {
      double sum = 0.0;
      for (; part < end_[static_cast<std::size_t>(j)]; ++part)
        sum += parts_[part].share * factor.at(i, parts_[part].column);
      out[j] = sum;
    }
    return out;
  }

 private:
  struct Part {
    int column;
    double share;
  };
  static constexpr auto kColumns = static_cast<std::size_t>(Q) + 1;
  std::array<Part, kColumns* static_cast<std::size_t>(kRowColumns)> parts_;
  std::array<std::size_t, kColumns> end_{};  // of each column's parts
};

/// Which scales take part.
using ScaleMask = std::array<bool, kScales>;
inline constexpr ScaleMask kAllScales{true, true, true, true, true};

/// Least squares over all scales, each weighted by the inverse of its own residual variance
/// (fixed-point iteration, METHODS: feasible generalised least squares).
template <int Q>
struct WeightedFit {
  using Vector = Eigen::Matrix<double, Q, 1>;
  using Square = Eigen::Matrix<double, Q, Q>;
  Vector theta = Vector::Zero();
  std::array<double, kScales> weight{};  ///< 1 / sigma_s^2
  Square inverse = Square::Zero();       ///< (sum_s w_s X'X)^-1
  double objective{0.0};                 ///< sum_s n_s log sigma_s^2: smaller is likelier
  double weighted_residual{0.0};         ///< sum_s w_s |X theta - t|^2
  double weighted_total{0.0};            ///< sum_s w_s |t|^2
  bool ok{false};
};

namespace detail {

inline constexpr int kWeightIterations = 5;

template <int Q>
using ScaleInformation = std::array<Information<Q + 1>, kScales>;

template <int Q>
ScaleInformation<Q> map_scales(const ScaleFactors& factors, const ColumnMap<Q>& map,
                               const ScaleMask& mask) noexcept {
  const MappedColumns<Q> columns{map};
  ScaleInformation<Q> out{};
  for (std::size_t s = 0; s < kScales; ++s) {
    if (!mask[s] || !(factors.rows[s] > 0.0)) continue;
    for (int i = 0; i < kRowColumns; ++i) out[s].absorb(columns.row_of(factors.factor[s], i));
  }
  return out;
}

/// |X theta - t|^2 of one scale.
template <int Q>
double residual(const Information<Q + 1>& info, const Eigen::Matrix<double, Q, 1>& theta) noexcept {
  Eigen::Matrix<double, Q + 1, 1> extended;
  extended << theta, -1.0;
  double sum = 0.0;
  for (int i = 0; i <= Q; ++i) {
    const double r = info.row(i).dot(extended);
    sum += r * r;
  }
  return sum;
}

template <int Q>
double total(const Information<Q + 1>& info) noexcept {
  const double norm = info.column_norm(Q);
  return norm * norm;
}

}  // namespace detail

/// `factors`: the statistics; scales with fewer than 5 Q rows are skipped. `prior`: information
/// from elsewhere, in units of one standard deviation.
template <int Q>
WeightedFit<Q> weighted_fit(const ScaleFactors& factors, const ColumnMap<Q>& map,
                            const ScaleMask& mask, const Information<Q + 1>& prior = {}) noexcept {
  WeightedFit<Q> fit;
  ScaleMask used = mask;
  for (std::size_t s = 0; s < kScales; ++s) used[s] = mask[s] && factors.rows[s] >= 5.0 * Q;
  const auto scales = detail::map_scales<Q>(factors, map, used);
  for (std::size_t s = 0; s < kScales; ++s) {
    const double t = detail::total<Q>(scales[s]);
    if (used[s] && t > 0.0) fit.weight[s] = factors.rows[s] / t;
  }
  for (int iteration = 0; iteration < detail::kWeightIterations; ++iteration) {
    Information<Q + 1> sum = prior;
    for (std::size_t s = 0; s < kScales; ++s) {
      if (!(fit.weight[s] > 0.0)) continue;
      const double root = std::sqrt(fit.weight[s]);
      for (int i = 0; i <= Q; ++i) sum.absorb(root * scales[s].row(i));
    }
    fit.ok = sum.solve(fit.theta);
    if (!fit.ok) return fit;
    fit.inverse = sum.inverse();
    fit.objective = fit.weighted_residual = fit.weighted_total = 0.0;
    for (std::size_t s = 0; s < kScales; ++s) {
      if (!(fit.weight[s] > 0.0)) continue;
      const double rss = detail::residual<Q>(scales[s], fit.theta);
      fit.weighted_residual += fit.weight[s] * rss;
      fit.weighted_total += fit.weight[s] * detail::total<Q>(scales[s]);
      fit.objective += factors.rows[s] * std::log(rss / factors.rows[s]);
      fit.weight[s] = factors.rows[s] / rss;
    }
  }
  return fit;
}

/// Every row of an entry's factors that a fit used, mapped, with its weight: visit(weight, row).
template <int Q, class Visit>
void for_each_row(const WeightedFit<Q>& fit, const ScaleFactors& entry,
                  const MappedColumns<Q>& columns, const Visit& visit) noexcept {
  for (std::size_t s = 0; s < kScales; ++s) {
    if (!(fit.weight[s] > 0.0)) continue;
    for (int i = 0; i < kRowColumns; ++i) visit(fit.weight[s], columns.row_of(entry.factor[s], i));
  }
}
/// Grouped rows were weighed before.
template <int Q, class Visit>
void for_each_row(const WeightedFit<Q>& fit, const GroupedFactors& entry,
                  const MappedColumns<Q>& columns, const Visit& visit) noexcept {
  for (std::size_t s = 0; s < kScales; s += kScales - 1) {  // the first of each group
    if (!(fit.weight[s] > 0.0)) continue;
    for (int i = 0; i < kRowColumns; ++i) visit(1.0, columns.row_of(entry.factor[group_of(s)], i));
  }
}

/// X'(t - X theta) of an entry.
template <int Q, class Entry>
typename WeightedFit<Q>::Vector score_of(const WeightedFit<Q>& fit, const Entry& entry,
                                         const MappedColumns<Q>& columns) noexcept {
  typename WeightedFit<Q>::Vector score = WeightedFit<Q>::Vector::Zero();
  for_each_row(fit, entry, columns, [&](double weight, const auto& row) {
    score += weight * (row[Q] - row.template head<Q>().dot(fit.theta)) * row.template head<Q>();
  });
  return score;
}

/// Covariance of a fit from the scores of the entries.
template <int Q>
Eigen::Matrix<double, Q, Q> score_covariance(const WeightedFit<Q>& fit, EntryList entries,
                                             const ColumnMap<Q>& map,
                                             const Information<Q + 1>& /*prior*/ = {}) noexcept {
  const MappedColumns<Q> columns{map};
  ScoreScatter<Q> scatter;
  for (const ScaleFactors* entry : entries) scatter.add(score_of(fit, *entry, columns));
  return scatter.covariance(fit.inverse);
}
/// The same of grouped entries: their weights are not the fit's to the last digit, so that the
/// information is theirs too.
template <int Q>
Eigen::Matrix<double, Q, Q> score_covariance(const WeightedFit<Q>& fit, GroupedList entries,
                                             const ColumnMap<Q>& map,
                                             const Information<Q + 1>& prior = {}) noexcept {
  const MappedColumns<Q> columns{map};
  ScoreScatter<Q> scatter;
  Information<Q + 1> sum = prior;
  for (const GroupedFactors* entry : entries) {
    scatter.add(score_of(fit, *entry, columns));
    for_each_row(fit, *entry, columns,
                 [&sum](double /*weight*/, const auto& row) { sum.absorb(row); });
  }
  typename WeightedFit<Q>::Vector theta;
  if (!sum.solve(theta)) return fit.inverse;
  return scatter.covariance(sum.inverse());
}

/// Factor on a standard deviation that came from the scatter of `count` blocks: few blocks scatter
/// less around their own mean than around the truth. Fitted to 96 simulated records of 20, 40, 60,
/// 120 and 300 s each (docs/adr/0004-stated-deviation.md).
inline double short_record_factor(double count) noexcept {
  return count > 4.0 ? 1.0 + 3.0 / (count - 3.0) : 4.0;
}

/// Weighted normal equations of all scales, [X t]'[X t].
template <int Q, class Entry>
Eigen::Matrix<double, Q + 1, Q + 1> weighted_gram(const WeightedFit<Q>& fit, const Entry& entry,
                                                  const MappedColumns<Q>& columns) noexcept {
  Eigen::Matrix<double, Q + 1, Q + 1> gram = Eigen::Matrix<double, Q + 1, Q + 1>::Zero();
  for_each_row(fit, entry, columns, [&gram](double weight, const auto& row) {
    gram += weight * row.lazyProduct(row.transpose());
  });
  return gram;
}

/// |X theta - t|^2 from the normal equations.
template <int Q>
double error_of(const Eigen::Matrix<double, Q + 1, Q + 1>& gram,
                const Eigen::Matrix<double, Q, 1>& theta) noexcept {
  Eigen::Matrix<double, Q + 1, 1> extended;
  extended << -theta, 1.0;
  return extended.dot(gram.lazyProduct(extended));
}

/// NaN where the normal equations do not determine theta.
template <int Q>
Eigen::Matrix<double, Q, 1> solve(const Eigen::Matrix<double, Q + 1, Q + 1>& gram) noexcept {
  return solve_cholesky<Q>(gram.template topLeftCorner<Q, Q>(),
                           gram.template topRightCorner<Q, 1>());
}

struct HeldOut {
  double error{0.0};  ///< |X theta - t|^2, theta from the other folds
  double total{0.0};  ///< |t|^2
};

/// `count` entries, each predicted from those of the other folds, which are interleaved. `of(i)`:
/// normal equations of entry i.
template <int Q, std::size_t Folds, class Of>
HeldOut held_out(std::size_t count, const Of& of) noexcept {
  using Gram = Eigen::Matrix<double, Q + 1, Q + 1>;
  Gram all = Gram::Zero();
  std::array<Gram, Folds> held_of;
  held_of.fill(all);
  for (std::size_t b = 0; b < count; ++b) {
    const Gram gram = of(b);
    all += gram;
    held_of[b % Folds] += gram;
  }
  HeldOut out{.total = all(Q, Q)};
  for (const Gram& held : held_of) out.error += error_of<Q>(held, solve<Q>(Gram{all - held}));
  return out;
}

/// NMSE of the entries of a fit, held out.
template <int Q, std::size_t Folds, class Entries>
double held_out_nmse_of(const WeightedFit<Q>& fit, Entries entries,
                        const ColumnMap<Q>& map) noexcept {
  const MappedColumns<Q> columns{map};
  const HeldOut out = held_out<Q, Folds>(
      entries.size(), [&](std::size_t b) { return weighted_gram<Q>(fit, *entries[b], columns); });
  return out.error / out.total;
}

}  // namespace dampline

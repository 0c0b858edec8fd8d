// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "app/diagnosis/rig/regressor.hpp"

namespace dampline::app::rig {

/// A choice among an evidence's columns.
using ColumnSet = std::vector<Eigen::Index>;

/// A least-squares fit of some columns, judged on what was held out.
struct Fit {
  bool ok{false};
  Eigen::VectorXd theta;
  Eigen::MatrixXd covariance;             ///< from the scatter of the blocks
  std::vector<Eigen::VectorXd> left_out;  ///< theta without each fold
  Eigen::VectorXd half_difference;        ///< theta of the records' first halves less the second's
  std::vector<double> record_nmse;        ///< held out, by record
  std::vector<double> block_error;        ///< held out, by block; their mean is the nmse
  double held_out_nmse{0.0};

  /// Whether it leaves less than another one, which may have failed.
  [[nodiscard]] bool beats(const Fit& other) const {
    return ok && (!other.ok || held_out_nmse < other.held_out_nmse);
  }
  /// A coefficient by its place in theta.
  [[nodiscard]] Estimate estimate(Eigen::Index i) const {
    return {theta[i], std::sqrt(std::max(covariance(i, i), 0.0))};
  }
};

/// Share of what `before` leaves that `after` takes away.
[[nodiscard]] inline double gain_of(const Fit& before, const Fit& after) {
  return 1.0 - after.held_out_nmse / before.held_out_nmse;
}

/// Equations of one record, the force as the last column, without what is left out.
struct Equations {
  Eigen::MatrixXd values;
  std::vector<Eigen::Index> sample;  ///< of the record, of each row
  double weight{0.0};                ///< 1 / (N var f), standstill apart
};
/// `filtered`: as beside an inertia.
[[nodiscard]] std::vector<Equations> equations_of(const std::vector<Regressor>& columns,
                                                  const std::vector<Series>& records,
                                                  bool filtered);
[[nodiscard]] inline std::vector<Equations> equations_of(const std::vector<Regressor>& columns,
                                                         const std::vector<Series>& records) {
  return equations_of(columns, records, is_filtered(columns));
}

/// Sums of products of all columns, block by block. Every record counts alike: its rows are divided
/// by N var f. Held out are whole records where there are three or more, otherwise blocks, dealt
/// out to five folds by a fixed shuffle, so that they keep no step with the motion.
class Regression {
 public:
  Regression(const std::vector<Regressor>& columns, const std::vector<Series>& records)
      : Regression{equations_of(columns, records)} {}
  explicit Regression(const std::vector<Equations>& records);

  /// `ridge`: of the diagonal, for columns that overlap.
  [[nodiscard]] Fit fit(const ColumnSet& set, double ridge) const;
  [[nodiscard]] std::size_t folds() const { return folds_; }

 private:
  struct Block {
    Eigen::MatrixXd products;
    std::size_t record;
    std::size_t fold;
    bool is_first_half;
  };

  std::vector<Block> blocks_;
  std::size_t records_;
  std::size_t folds_;
};

/// How sure it is that `after` predicts better: mean over deviation of the mean of the blocks'
/// improvements.
[[nodiscard]] double block_t(const Fit& before, const Fit& after);

/// Standard deviation of a figure, from what it is with each part of the data left out in turn.
[[nodiscard]] double jackknife_std(const std::vector<double>& left_out);

[[nodiscard]] inline ColumnSet joined(ColumnSet a, const ColumnSet& b) {
  for (const Eigen::Index i : b)
    if (std::find(a.begin(), a.end(), i) == a.end()) a.push_back(i);
  return a;
}

/// Where a column of the set stands in theta.
[[nodiscard]] inline Eigen::Index place_of(const ColumnSet& set, Eigen::Index column) {
  return std::find(set.begin(), set.end(), column) - set.begin();
}

[[nodiscard]] inline bool is_memory(const std::string& effect) {
  return effect == "backlash" || effect == "presliding_hysteresis";
}

}  // namespace dampline::app::rig

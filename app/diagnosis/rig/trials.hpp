// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/diagnosis/rig/explanation.hpp"

namespace dampline::app::rig {

/// The model that a trial starts from.
struct TrialBase {
  std::vector<Regressor> columns;   ///< beside the sign of v
  std::vector<Regressor> friction;  ///< ways to write sign v; empty: it is not in the model
  double ridge{0.0};
};

/// Fits of one base with any of some more columns, of one pass over the records.
class TrialFits {
 public:
  TrialFits(const std::vector<Series>& records, const TrialBase& base,
            std::vector<Regressor> more = {});
  /// The best fit of all ways to write sign v. `more`: numbers of the columns beside the base; they
  /// follow the base's in theta.
  [[nodiscard]] Fit best(const ColumnSet& more = {}) const;
  struct Best {
    std::size_t place{0};  ///< of the column beside the base
    Fit fit;               ///< not ok where there is none
  };
  /// Of the first `count` columns beside the base, each in turn: the one that leaves least with a
  /// coefficient above 0.
  [[nodiscard]] Best best_positive(std::size_t count) const;
  /// The way to write sign v that fits best; nothing where the base has none.
  [[nodiscard]] std::optional<Regressor> friction() const;

 private:
  [[nodiscard]] Fit fit(const ColumnSet& more, std::size_t friction) const;

  TrialBase base_;
  Regression evidence_;
};

/// The best fit of all ways to write sign v.
[[nodiscard]] Fit best_fit(const std::vector<Series>& records, const TrialBase& base);

/// An effect that is no column of the motion as it was measured: another instant, or a law that
/// changes over the record.
struct Trial {
  std::string effect;
  Fit fit;
  double gain{0.0};
  double t{0.0};
  std::vector<Regressor> columns;  ///< that it adds
  double skew_s{0.0};              ///< the force is late by this
  std::string parameter;           ///< what drifts
  Mode mode;                       ///< unmodelled_mode; without columns the force passes it
  double at_share{-1.0};           ///< of the record, where it changes at once; -1: otherwise
  std::vector<Change> changes;     ///< of a friction with memory

  /// Takes the fit and what it is worth.
  void judge(const Fit& without, const Fit& with) {
    fit = with;
    gain = gain_of(without, with);
    t = block_t(without, with);
  }
};

/// The motion as it was `skew_s` ago, beside the force of now.
[[nodiscard]] Series delayed(const Series& record, double skew_s);

/// Force and motion out of step by an eighth to twelve samples.
[[nodiscard]] std::optional<Trial> try_skew(const std::vector<Series>& records,
                                            const TrialBase& base);
/// A mass on a spring that stands on what moves, its resonance as high as one that moves along
/// still shows.
[[nodiscard]] std::optional<Trial> try_attached(const std::vector<Series>& records,
                                                const TrialBase& base);
/// A mass on a spring between the damper and the force's sensor, which must resonate: what only
/// lags is no mode.
[[nodiscard]] std::optional<Trial> try_path(const std::vector<Series>& records,
                                            const TrialBase& base);
/// The friction, the viscous part or the spring changes over the record: evenly, or at once.
[[nodiscard]] std::optional<Trial> try_drift(const std::vector<Series>& records,
                                             const TrialBase& base);

/// The state of Bouc and Wen's hysteresis in metres, dz = dx - (|dx| z + b dx |z|) / a: over the
/// travel a it forgets where it turned; b = 0 is Dahl's, b below -1 one that never slips. Slipping
/// at the start where it moves, 0 where it rests. Wen 1976, exponent 1.
[[nodiscard]] Eigen::VectorXd bouc_wen(const Eigen::VectorXd& deflection_m, double travel_m,
                                       double shape);

/// Where it slips, in metres: the largest state; 0 where it never comes to slip.
[[nodiscard]] double bouc_wen_slip_m(double travel_m, double shape);

struct BestColumn {
  Regressor column;
  Fit fit;
};

/// The one that leaves least beside a base; nothing where none helps.
[[nodiscard]] std::optional<BestColumn> best_bouc_wen(const std::vector<Series>& records,
                                                      const TrialBase& base, double deflection_m);
/// The same of a spring behind a dashpot; `times_s`: where to look.
[[nodiscard]] std::optional<BestColumn> best_viscoelastic(const std::vector<Series>& records,
                                                          const TrialBase& base,
                                                          const std::vector<double>& times_s);

}  // namespace dampline::app::rig

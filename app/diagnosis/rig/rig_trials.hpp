// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/diagnosis/rig/rig_explanation.hpp"

namespace dampline::app {

/// The model that a trial starts from.
struct RigTrialBase {
  std::vector<RigColumn> columns;   ///< beside the sign of v
  std::vector<RigColumn> friction;  ///< ways to write sign v; empty: it is not in the model
  double ridge{0.0};
};

/// Fits of one base with any of some more columns, of one pass over the records.
class TrialFits {
 public:
  TrialFits(const std::vector<RigSeries>& records, const RigTrialBase& base,
            std::vector<RigColumn> more = {});
  /// The best fit of all ways to write sign v. `more`: numbers of the columns beside the base; they
  /// follow the base's in theta.
  [[nodiscard]] RigFit best(const ColumnSet& more = {}) const;
  struct Best {
    std::size_t place{0};  ///< of the column beside the base
    RigFit fit;            ///< not ok where there is none
  };
  /// Of the first `count` columns beside the base, each in turn: the one that leaves least with a
  /// coefficient above 0.
  [[nodiscard]] Best best_positive(std::size_t count) const;
  /// The way to write sign v that fits best; nothing where the base has none.
  [[nodiscard]] std::optional<RigColumn> friction() const;

 private:
  [[nodiscard]] RigFit fit(const ColumnSet& more, std::size_t friction) const;

  RigTrialBase base_;
  RigEvidence evidence_;
};

/// The best fit of all ways to write sign v.
[[nodiscard]] RigFit best_fit(const std::vector<RigSeries>& records, const RigTrialBase& base);

/// An effect that is no column of the motion as it was measured: another instant, or a law that
/// changes over the record.
struct RigTrial {
  std::string effect;
  RigFit fit;
  double gain{0.0};
  double t{0.0};
  std::vector<RigColumn> columns;  ///< that it adds
  double skew_s{0.0};              ///< the force is late by this
  std::string parameter;           ///< what drifts
  RigMode mode;                    ///< unmodelled_mode; without columns the force passes it
  double at_share{-1.0};           ///< of the record, where it changes at once; -1: slowly
};

/// The motion as it was `skew_s` ago, beside the force of now.
[[nodiscard]] RigSeries delayed(const RigSeries& record, double skew_s);

/// Force and motion out of step by an eighth to twelve samples.
[[nodiscard]] std::optional<RigTrial> try_skew(const std::vector<RigSeries>& records,
                                               const RigTrialBase& base);
/// Standard deviation of a skew, by the jackknife over the blocks.
[[nodiscard]] double skew_deviation(const std::vector<RigSeries>& records, const RigTrialBase& base,
                                    double skew_s);
/// Standard deviation of what one parameter is, from the fits a step below it, at it and above; the
/// step where one of them failed.
[[nodiscard]] double deviation_of(const RigFit& low, const RigFit& middle, const RigFit& high,
                                  double step);

/// A mass on a spring that stands on what moves, its resonance as high as one that moves along
/// still shows.
[[nodiscard]] std::optional<RigTrial> try_attached(const std::vector<RigSeries>& records,
                                                   const RigTrialBase& base);
/// A mass on a spring between the damper and the force's sensor, which must resonate: what only
/// lags is no mode.
[[nodiscard]] std::optional<RigTrial> try_path(const std::vector<RigSeries>& records,
                                               const RigTrialBase& base);
/// Standard deviations of a mode's two parameters.
[[nodiscard]] RigMode mode_deviation(const std::vector<RigSeries>& records,
                                     const RigTrialBase& base, const RigTrial& trial);

/// The friction, the viscous part or the spring changes over the record: evenly, or at once.
[[nodiscard]] std::optional<RigTrial> try_drift(const std::vector<RigSeries>& records,
                                                const RigTrialBase& base);

}  // namespace dampline::app

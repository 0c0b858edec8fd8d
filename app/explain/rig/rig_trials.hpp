// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/explain/rig/rig_explanation.hpp"

namespace dampline::app {

/// The model that a trial starts from.
struct RigTrialBase {
  std::vector<RigColumn> columns;   ///< beside the sign of v
  std::vector<RigColumn> friction;  ///< ways to write sign v; empty: it is not in the model
  double ridge{0.0};
};

/// The best fit of all ways to write sign v, with `more` columns beside.
[[nodiscard]] RigFit best_fit(const std::vector<RigSeries>& records, const RigTrialBase& base,
                              const std::vector<RigColumn>& more = {});

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
/// The friction, the viscous part or the spring changes over the record: evenly, or at once.
[[nodiscard]] std::optional<RigTrial> try_drift(const std::vector<RigSeries>& records,
                                                const RigTrialBase& base);

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/diagnosis/rig/rig_mode.hpp"
#include "dampline/rig/rig_config.hpp"

namespace dampline::app {

/// A rig's record in memory: motion and force at a uniform rate. Samples that are no number are
/// left out; over a gap the motion goes on.
struct RigSeries {
  std::string record;
  std::vector<std::string> notes;  ///< what was done to the record, a sentence each
  double interval_s{0.0};
  bool has_gap{false};
  RigConfig config;  ///< test function and derivative, as the record's noise permits
  Eigen::VectorXd time_s;
  Eigen::VectorXd deflection_m;
  Eigen::VectorXd velocity_mps;
  Eigen::VectorXd force_n;
  Eigen::VectorXd reference_n;  ///< another prediction of the force, NaN where there is none; empty
  Eigen::VectorXd accel_mps2;   ///< measured beside the deflection; empty: it is not
  Eigen::VectorXd left_out;     ///< 1: takes no part in a fit or its error; empty: none
  double noise_m{0.0};          ///< of the deflection, rms
  RigMode path;                 ///< that a force passes before it is measured
  double start_m{0.0};          ///< slip of all friction elements at the first sample

  [[nodiscard]] Eigen::Index size() const { return force_n.size(); }
};

/// Samples on either side of a reversal where the sign of the velocity is uncertain, and with it
/// the friction.
[[nodiscard]] inline Eigen::Index reach_of_reversal(const RigSeries& series) {
  return 3 + series.config.velocity_half_width;
}

/// Reads a record. `reference_column`: a column of another prediction; empty: none. Throws RunError
/// naming the file, what was found and what was expected.
[[nodiscard]] RigSeries read_rig_series(const std::string& path, const Config& config,
                                        bool skip_bad_lines,
                                        const std::string& reference_column = {});

}  // namespace dampline::app

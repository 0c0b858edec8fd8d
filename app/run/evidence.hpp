// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace dampline::app {

/// What a model leaves of the force, in one bin of what it is seen over.
struct ResidualRow {
  std::string over;   ///< "deflection_m", "velocity_mps", "frequency_hz", "time_s"
  double place{0.0};  ///< centre of the bin
  std::uint64_t samples{0};
  double before_mean_n{0.0};  ///< base model; 0 over frequency
  double before_rms_n{0.0};
  double after_mean_n{0.0};  ///< final model
  double after_rms_n{0.0};
};

/// One instant of an excerpt: the force that was measured, and both models' of it.
struct LoopRow {
  double time_s{0.0};
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double measured_n{0.0};
  double base_n{0.0};
  double final_n{0.0};
};

/// The damping force in steady sliding, undeflected.
struct LawRow {
  double velocity_mps{0.0};
  double base_n{0.0};
  double final_n{0.0};
};

/// One instant of a record that was never fitted.
struct PredictedRow {
  std::uint32_t record{1};
  double time_s{0.0};
  double measured_n{0.0};
  double predicted_n{0.0};  ///< final model
  double base_n{0.0};
  double reference_n{std::numeric_limits<double>::quiet_NaN()};  ///< NaN: there is none
};

/// What the report of an explanation shows beside explanation.json.
struct Evidence {
  std::string explanation;  ///< explanation.json as text; empty: the run explained nothing
  std::vector<ResidualRow> residual;
  std::vector<LoopRow> loops;
  std::vector<LawRow> law;
  std::vector<PredictedRow> prediction;
};

}  // namespace dampline::app

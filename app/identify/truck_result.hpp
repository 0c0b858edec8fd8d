// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <vector>

#include "app/config/config.hpp"
#include "app/identify/convergence_history.hpp"
#include "app/identify/rate_correction.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// A truck record when it is over.
struct TruckRecord {
  Snapshot snapshot;          ///< corrected
  RateCorrection correction;  ///< that was applied
  MeasuredRate measured;
  double sample_rate_hz{0.0};  ///< in use: measured where that was possible
  std::int64_t first_tick{0};
  std::int64_t newest_tick{0};
  [[nodiscard]] double time_s(std::int64_t tick) const noexcept {
    return static_cast<double>(tick - first_tick) / sample_rate_hz;
  }
};

/// Parameters, curve, counts, fit, verdicts and notes.
[[nodiscard]] RunResult describe_truck(const TruckRecord& record, const ModelConfig& model);

/// History and excerpt, in the record's own time and rate.
void fill_history(const std::vector<ConvergenceHistory::Row>& rows, const TruckRecord& record,
                  RunResult& result);
void fill_motion(const std::vector<Motion>& motion, const TruckRecord& record, RunResult& result);

}  // namespace dampline::app

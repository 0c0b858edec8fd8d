// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <vector>

#include "app/config/config.hpp"
#include "app/identify/collected.hpp"
#include "app/record/rate.hpp"
#include "app/run/result.hpp"
#include "dampline/density/fokker_planck.hpp"
#include "dampline/faults.hpp"
#include "dampline/guard/guard.hpp"
#include "dampline/guard/parameter_drift.hpp"
#include "dampline/phase/view.hpp"

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

/// Names, sizes and times in the record's own time; no spans.
void describe_faults(const FaultView& view, const TruckRecord& record, double nominal_hz,
                     DataFaults& out);

/// Precondition: drift.found.
[[nodiscard]] DriftFinding finding_of(const ParameterDrift& drift);

/// A fault of the whole record that is found afterwards, and that changes the numbers.
void add_fault(FaultKind kind, FaultChannel channel, double size, RunResult& result);

/// End of the record: the same with the seconds that each fault spoils and a parameter that
/// changed, with a warning for the reader where there is any of them. `view`: the guard's.
void describe_faults_of_all(const Guard& guard, const FaultView& view, const ParameterDrift& drift,
                            const TruckRecord& record, double nominal_hz, RunResult& result);

/// To the result, in the record's own time, with a warning for each.
void describe_alarms(const AlarmView& view, const TruckRecord& record, RunResult& result);

/// Densities of the motion, in the record's own time.
void fill_densities(const FokkerPlanck& statistics, const TruckRecord& record, RunResult& result);

/// The planes of the phase space and the sections, in the record's own time.
void fill_phase(const PhaseView& view, const TruckRecord& record, RunResult& result);

/// Every method's level, verdict, and force at the velocities of the curve, which is there already.
/// `nominal_stiffness_npm` belongs to the nominal rate, as the statistics do.
void fill_methods(const FokkerPlanck& statistics, double mass_kg, double nominal_stiffness_npm,
                  const TruckRecord& record, RunResult& result);

}  // namespace dampline::app

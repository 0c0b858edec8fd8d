// SPDX-License-Identifier: MIT
#pragma once
#include "app/identify/truck_result.hpp"
#include "dampline/faults.hpp"
#include "dampline/guard/guard.hpp"
#include "dampline/guard/parameter_drift.hpp"

namespace dampline::app {

/// Names, sizes and times in the record's own time; no spans.
void describe_faults(const FaultView& view, const TruckRecord& record, double nominal_hz,
                     DataFaults& out);

/// Precondition: drift.found.
[[nodiscard]] DriftFinding finding_of(const ParameterDrift& drift);

/// End of the record: the same with the seconds that each fault spoils and a parameter that
/// changed, with a warning for the reader where there is any of them. `view`: the guard's.
void describe_faults_of_all(const Guard& guard, const FaultView& view, const ParameterDrift& drift,
                            const TruckRecord& record, double nominal_hz, RunResult& result);

/// To the result, in the record's own time, with a warning for each.
void describe_alarms(const AlarmView& view, const TruckRecord& record, RunResult& result);

}  // namespace dampline::app

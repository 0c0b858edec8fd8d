// SPDX-License-Identifier: MIT
#pragma once
#include "app/identify/truck_result.hpp"
#include "dampline/density/fokker_planck.hpp"
#include "dampline/phase/view.hpp"

namespace dampline::app {

/// Densities of the motion, in the record's own time.
void fill_densities(const FokkerPlanck& statistics, const TruckRecord& record, RunResult& result);

/// The planes of the phase space and the sections, in the record's own time.
void fill_phase(const PhaseView& view, const TruckRecord& record, RunResult& result);

/// Every method's level, verdict, and force at the velocities of the curve, which is there already.
/// `nominal_stiffness_npm` belongs to the nominal rate, as the statistics do.
void fill_methods(const FokkerPlanck& statistics, double mass_kg, double nominal_stiffness_npm,
                  const TruckRecord& record, RunResult& result);

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>

#include "dampline/damping/estimator.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::test {

/// A laden car of two trucks whose frames pitch, with both sensors more, and what identifies it.
struct PitchingCar {
  sim::SimulationConfig simulation{sim::reference_run(sim::Load::kLaden, 80.0, 4)};
  EstimatorConfig estimator{};
  PitchingCar() {
    simulation.vehicle.emplace();
    simulation.extra_sensors = true;
    sim::ModeEffects& modes = simulation.truck.modes;
    modes.pitch_inertia_kgm2 = sim::kFramePitchInertiaKgm2;
    const sim::VehicleMasses masses = sim::masses_of(*simulation.vehicle, simulation.truck);
    estimator.moving_mass_kg = masses.own_kg;
    estimator.far_mass_kg = masses.other_kg;
    estimator.frame_pitch_mass_kg =
        modes.pitch_inertia_kgm2 / std::pow(modes.pitch_half_wheelbase_m, 2);
  }
};

}  // namespace dampline::test

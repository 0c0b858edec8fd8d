// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/spread.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/density/fokker_planck.hpp"
#include "sim_hw/simulation.hpp"
#include "sim_hw/vehicle.hpp"

namespace dampline::bench {

/// Two loads, three rides, three sections of line.
struct Case {
  sim::Load load;
  double speed_kmh;
  bool poor_track;
  std::uint64_t section;
  [[nodiscard]] bool laden() const { return load == sim::Load::kLaden; }
};

inline std::vector<Case> cases(std::uint64_t first_section) {
  std::vector<Case> all;
  for (const auto load : {sim::Load::kLaden, sim::Load::kEmpty}) {
    for (const auto& [speed_kmh, poor] : {std::pair{60.0, false}, {80.0, false}, {80.0, true}}) {
      for (std::uint64_t i = 0; i < 3; ++i)
        all.push_back({load, speed_kmh, poor, first_section + i});
    }
  }
  return all;
}

inline constexpr std::size_t kModels = 3;
/// How much of equation 1 is simulated.
struct Model {
  std::string name;
  bool body_couples;  // the body's mass is not at the pivots
  bool frames_pitch;  // the frames have inertia
};

inline const std::array<Model, kModels>& models() {
  static const std::array<Model, kModels> all{{{"equation 2: trucks apart", false, false},
                                               {"body couples the trucks", true, false},
                                               {"four degrees of freedom", true, true}}};
  return all;
}

inline sim::SimulationConfig simulation_of(const Case& c, const Model& model,
                                           sim::TruckPosition truck) {
  sim::SimulationConfig config = sim::reference_run(c.load, c.speed_kmh, c.section);
  if (c.poor_track) config.track.amplitude_m_rad = sim::kTrackAmplitudeHigh;
  sim::VehicleConfig vehicle;
  if (!model.body_couples) vehicle.gyration_radius_m = vehicle.half_pivot_distance_m;
  vehicle.instrumented = truck;
  config.vehicle = vehicle;
  if (model.frames_pitch) config.truck.modes.pitch_inertia_kgm2 = sim::kFramePitchInertiaKgm2;
  return config;
}

/// What is compared: the shipped window estimate and the Fokker-Planck forms.
enum Method : std::size_t { kWindow, kKnownInput, kWeak, kPaper, kMethods };

struct Level {
  Estimate force_n;
  bool has_number{false};
  bool trusted{false};
};
using Found = std::array<Level, kMethods>;

inline Level level_of(const MethodResult& result) {
  return {result.level_n, result.verdict.has_number, result.verdict.trusted};
}

/// The levels from one truck's three accelerometers; the mass is m_frame + m_body / 2 and, for the
/// Fokker-Planck forms, the stiffness is known, as in the paper.
inline Found find_levels(const sim::SimulationConfig& config, double seconds) {
  const sim::TruckConfig& truck = config.truck;
  EstimatorConfig identifier_config;
  identifier_config.moving_mass_kg = truck.moving_mass_kg;
  const auto identifier = std::make_unique<Estimator>(identifier_config);
  const auto densities = std::make_unique<FokkerPlanck>(FokkerPlanckConfig{});
  sim::Simulation simulation{config};
  const auto samples = std::llround(seconds * sim::kSampleRateHz);
  for (std::int64_t i = 0; i < samples; ++i) {
    const UpdateResult result = identifier->update(sim::to_sample(simulation.next()));
    if (result.has_motion) densities->update(result.motion);
  }
  identifier->finish();
  const Snapshot snapshot = identifier->snapshot();
  const FokkerPlanckEstimates estimates =
      densities->estimates(truck.moving_mass_kg, truck.stiffness_npm);
  return {Level{snapshot.coulomb_n, snapshot.valid, snapshot.valid},
          level_of(estimates.known_input), level_of(estimates.weak), level_of(estimates.paper)};
}

using Trucks = std::array<Found, 2>;  // leading, trailing

inline Trucks find_levels(const Case& c, const Model& model, double seconds) {
  return {find_levels(simulation_of(c, model, sim::TruckPosition::kLeading), seconds),
          find_levels(simulation_of(c, model, sim::TruckPosition::kTrailing), seconds)};
}

/// A case's level is the mean of its trucks'.
inline Spread over_trucks(const Trucks& trucks, Method method) {
  Spread spread;
  for (const Found& found : trucks)
    if (found[method].has_number) spread.add(found[method].force_n.value);
  return spread;
}

}  // namespace dampline::bench

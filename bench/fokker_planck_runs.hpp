// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bench/curve_error.hpp"
#include "bench/spread.hpp"
#include "dampline/methods.hpp"
#include "sim_hw/simulation.hpp"
#include "sim_hw/white_input.hpp"

namespace dampline::bench {

enum Form : std::size_t { kWeak, kPaper, kKnownInput, kForms };

inline const std::array<std::string, kForms> kFormNames{"weak form", "paper's form, v = 0 left out",
                                                        "known input"};

inline const MethodResult& of(const FokkerPlanckEstimates& found, std::size_t form) {
  if (form == kWeak) return found.weak;
  return form == kPaper ? found.paper : found.known_input;
}

/// What one form did over several runs.
struct Tally {
  Spread level;  ///< relative; of the runs with a number
  Spread curve;  ///< relative distance of the curve over |v| > 3 mm/s
  Spread sigma;  ///< error of the level over its stated deviation
  int runs{0};
  int trusted{0};
};
using Tallies = std::array<Tally, kForms>;

inline double level_of(const sim::TruckConfig& truck) {
  return 0.5 * (truck.friction_positive_n + truck.friction_negative_n);
}

/// `absolute`: the branches themselves are observable, otherwise only half their sum.
inline void tally(const FokkerPlanck& data, const sim::TruckConfig& truck, bool absolute,
                  Tallies& all) {
  const FokkerPlanckEstimates found = data.estimates(truck.moving_mass_kg, truck.stiffness_npm);
  const double level_n = level_of(truck);
  const double positive_n = absolute ? truck.friction_positive_n : level_n;
  const double negative_n = absolute ? truck.friction_negative_n : level_n;
  for (std::size_t form = 0; form < kForms; ++form) {
    const MethodResult& result = of(found, form);
    Tally& t = all[form];
    ++t.runs;
    t.trusted += result.verdict.trusted ? 1 : 0;
    if (!result.verdict.has_number) continue;
    t.level.add(result.level_n.value / level_n - 1.0);
    t.curve.add(curve_error(result, data.velocities(), positive_n, negative_n));
    t.sigma.add((result.level_n.value - level_n) / result.level_n.std);
  }
}

struct White {
  sim::Load load{sim::Load::kLaden};
  double velocity_rms_mps{8.0e-3};
  double seconds{300.0};
  bool absolute{true};
};

inline sim::WhiteInputConfig white_input(const White& white, std::uint64_t seed) {
  const sim::TruckConfig truck = sim::truck_of(white.load);
  return {.seed = seed,
          .moving_mass_kg = truck.moving_mass_kg,
          .stiffness_npm = truck.stiffness_npm,
          .friction_positive_n = truck.friction_positive_n,
          .friction_negative_n = truck.friction_negative_n,
          .input_level =
              sim::input_level_for(white.velocity_rms_mps, level_of(truck), truck.moving_mass_kg)};
}

inline std::unique_ptr<FokkerPlanck> run(const White& white, std::uint64_t seed) {
  auto out =
      std::make_unique<FokkerPlanck>(FokkerPlanckConfig{.deflection_is_absolute = white.absolute});
  sim::WhiteInput source{white_input(white, seed)};
  const auto samples = std::llround(white.seconds * sim::WhiteInput::sample_rate_hz());
  for (std::int64_t i = 0; i < samples; ++i) out->update(source.next());
  return out;
}

struct Ride {
  sim::Load load{sim::Load::kLaden};
  double speed_kmh{80.0};
  double amplitude_m_rad{sim::kTrackAmplitudeLow};
  double short_wave_mps2{2.0};  ///< corrugation
  double seconds{300.0};
};

inline sim::SimulationConfig simulation_of(const Ride& ride, std::uint64_t seed) {
  sim::SimulationConfig config =
      sim::reference_run(ride.load, ride.speed_kmh, seed, ride.short_wave_mps2);
  config.track.amplitude_m_rad = ride.amplitude_m_rad;
  return config;
}

/// The motion that the shipped identifier finds in the three accelerations.
inline std::unique_ptr<Methods> run(const Ride& ride, std::uint64_t seed) {
  const sim::SimulationConfig config = simulation_of(ride, seed);
  const EstimatorConfig identifier_config{.moving_mass_kg = config.truck.moving_mass_kg};
  const auto identifier = std::make_unique<Estimator>(identifier_config);
  auto methods = std::make_unique<Methods>(identifier_config);
  sim::Simulation simulation{config};
  const auto samples = std::llround(ride.seconds * sim::kSampleRateHz);
  for (std::int64_t i = 0; i < samples; ++i)
    methods->update(identifier->update(sim::to_sample(simulation.next())));
  return methods;
}

}  // namespace dampline::bench

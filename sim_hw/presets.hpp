// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "sim_hw/simulation.hpp"

namespace dampline::sim {

enum class Load : std::uint8_t { kLaden, kEmpty };

[[nodiscard]] inline TruckConfig truck_of(Load load) {
  return load == Load::kLaden ? laden_truck() : empty_truck();
}

/// A run at constant speed with the corrugation of the method study (60 +- 15 Hz at this speed).
/// With short_wave_mps2 = 2 the rms of y, v and z_b'' are those the study states: 0.3 to 0.8 mm,
/// 11 to 18 mm/s, 0.21 to 0.29 m/s^2; with 0, velocities are a third lower.
[[nodiscard]] inline SimulationConfig reference_run(Load load, double speed_kmh, std::uint64_t seed,
                                                    double short_wave_mps2 = 2.0) {
  SimulationConfig config;
  config.seed = seed;
  config.truck = truck_of(load);
  config.speed.speed_mps = speed_kmh / 3.6;
  config.track.nominal_speed_mps = config.speed.speed_mps;
  config.track.short_wave_mps2 = short_wave_mps2;
  return config;
}

}  // namespace dampline::sim

// SPDX-License-Identifier: MIT
#pragma once
#include <span>

#include "sim_hw/effects/registry.hpp"

namespace dampline::sim {

/// The rows behind effects(), by group.
[[nodiscard]] std::span<const Effect> effect_table() noexcept;

[[nodiscard]] Effect viscous_effect() noexcept;
[[nodiscard]] Effect asymmetric_viscous_effect() noexcept;
[[nodiscard]] Effect quadratic_damping_effect() noexcept;
[[nodiscard]] Effect coulomb_effect() noexcept;
[[nodiscard]] Effect asymmetric_coulomb_effect() noexcept;
[[nodiscard]] Effect offset_force_effect() noexcept;
[[nodiscard]] Effect progressive_friction_effect() noexcept;
[[nodiscard]] Effect stribeck_effect() noexcept;
[[nodiscard]] Effect presliding_hysteresis_effect() noexcept;
[[nodiscard]] Effect backlash_effect() noexcept;

[[nodiscard]] Effect bump_stop_effect() noexcept;
[[nodiscard]] Effect cubic_stiffness_effect() noexcept;
[[nodiscard]] Effect quadratic_stiffness_effect() noexcept;
[[nodiscard]] Effect asymmetric_stiffness_effect() noexcept;
[[nodiscard]] Effect time_drift_effect() noexcept;
[[nodiscard]] Effect unmodelled_mode_effect() noexcept;

[[nodiscard]] Effect time_skew_effect() noexcept;
[[nodiscard]] Effect gain_error_effect() noexcept;
[[nodiscard]] Effect cross_axis_effect() noexcept;
[[nodiscard]] Effect impulsive_input_effect() noexcept;

/// Fc = (F1 + F2) / 2 of a car.
[[nodiscard]] inline double coulomb_level_n(const SimulationConfig& config) noexcept {
  const TruckConfig& truck = config.truck;
  return 0.5 * truck.friction_scale * (truck.friction_positive_n + truck.friction_negative_n);
}

/// How far a car's deflection reaches compared with the laden car's.
[[nodiscard]] inline double reach(const SimulationConfig& config) noexcept {
  return config.truck.moving_mass_kg > 20000.0 ? 1.0 : 2.0 / 3.0;
}

/// A nominal value that is the same for every car.
template <int Millionths>
[[nodiscard]] double fixed(const SimulationConfig& /*config*/) noexcept {
  return Millionths * 1e-6;
}

}  // namespace dampline::sim

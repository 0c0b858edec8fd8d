// SPDX-License-Identifier: MIT
#include <array>

#include "sim_hw/effects/tables.hpp"

namespace dampline::sim {
namespace {

constexpr double kTypicalSpeedMps = 0.018;

/// A quarter of the Coulomb level at the speed that is typical on the track.
double viscous_nspm(const SimulationConfig& config) noexcept {
  return 0.25 * coulomb_level_n(config) / kTypicalSpeedMps;
}

}  // namespace

Effect viscous_effect() noexcept {
  static constexpr std::array<EffectParameter, 1> kParameters{
      {{"coefficient_nspm", Domain::kNotNegative, Strength::kTimes,
        [](const SimulationConfig& config) { return viscous_nspm(config); },
        [](SimulationConfig& config, double value) {
          config.truck.damping.viscous_positive_nspm = config.truck.damping.viscous_negative_nspm =
              value;
        }}}};
  return {"viscous", "c v", kParameters};
}

Effect asymmetric_viscous_effect() noexcept {
  static constexpr std::array<EffectParameter, 2> kParameters{
      {{"positive_nspm", Domain::kNotNegative, Strength::kTimes,
        [](const SimulationConfig& config) { return 1.5 * viscous_nspm(config); },
        [](SimulationConfig& config, double value) {
          config.truck.damping.viscous_positive_nspm = value;
        }},
       {"negative_nspm", Domain::kNotNegative, Strength::kTimes,
        [](const SimulationConfig& config) { return 0.5 * viscous_nspm(config); },
        [](SimulationConfig& config, double value) {
          config.truck.damping.viscous_negative_nspm = value;
        }}}};
  return {"asymmetric_viscous", "c+ v for v > 0, c- v for v < 0", kParameters};
}

Effect quadratic_damping_effect() noexcept {
  static constexpr std::array<EffectParameter, 1> kParameters{
      {{"coefficient_ns2pm2", Domain::kNotNegative, Strength::kTimes,
        [](const SimulationConfig& config) { return viscous_nspm(config) / kTypicalSpeedMps; },
        [](SimulationConfig& config, double value) {
          config.truck.damping.quadratic_ns2pm2 = value;
        }}}};
  return {"quadratic_damping", "q v |v|", kParameters};
}

Effect offset_force_effect() noexcept {
  static constexpr std::array<EffectParameter, 1> kParameters{
      {{"force_n", Domain::kAny, Strength::kTimes,
        [](const SimulationConfig& config) { return 0.1 * coulomb_level_n(config); },
        [](SimulationConfig& config, double value) { config.truck.damping.offset_n = value; }}}};
  return {"offset_force", "a constant force", kParameters};
}

}  // namespace dampline::sim

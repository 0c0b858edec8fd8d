// SPDX-License-Identifier: MIT
#include <array>

#include "sim_hw/effects/tables.hpp"

namespace dampline::sim {
namespace {

/// The deflection at which the nominal nonlinear part is 15 % of the linear one.
double typical_m(const SimulationConfig& config) noexcept { return 1.6e-3 * reach(config); }

}  // namespace

Effect bump_stop_effect() noexcept {
  static constexpr std::array<EffectParameter, 3> kParameters{
      {{"gap_m", Domain::kNotNegative, Strength::kNone,
        [](const SimulationConfig& config) { return 1.8e-3 * reach(config); },
        [](SimulationConfig& config, double value) { config.truck.stiffness.bump_gap_m = value; }},
       {"stiffness_npm", Domain::kPositive, Strength::kTimes,
        [](const SimulationConfig& config) { return 3.0 * config.truck.stiffness_npm; },
        [](SimulationConfig& config, double value) {
          config.truck.stiffness.bump_stiffness_npm = value;
        }},
       {"one_sided", Domain::kNotNegative, Strength::kNone, fixed<0>,
        [](SimulationConfig& config, double value) {
          config.truck.stiffness.bump_one_sided = value != 0.0;
        }}}};
  return {"bump_stop", "contact beyond a gap; one_sided=1: for y > 0 only", kParameters};
}

Effect cubic_stiffness_effect() noexcept {
  static constexpr std::array<EffectParameter, 1> kParameters{
      {{"coefficient_npm3", Domain::kAny, Strength::kTimes,
        [](const SimulationConfig& config) {
          return 0.15 * config.truck.stiffness_npm / (typical_m(config) * typical_m(config));
        },
        [](SimulationConfig& config, double value) {
          config.truck.stiffness.cubic_npm3 = value;
        }}}};
  return {"cubic_stiffness", "k3 y^3", kParameters};
}

Effect quadratic_stiffness_effect() noexcept {
  static constexpr std::array<EffectParameter, 1> kParameters{
      {{"coefficient_npm2", Domain::kAny, Strength::kTimes,
        [](const SimulationConfig& config) {
          return 0.15 * config.truck.stiffness_npm / typical_m(config);
        },
        [](SimulationConfig& config, double value) {
          config.truck.stiffness.quadratic_npm2 = value;
        }}}};
  return {"quadratic_stiffness", "k2 y^2", kParameters};
}

Effect asymmetric_stiffness_effect() noexcept {
  static constexpr std::array<EffectParameter, 1> kParameters{
      {{"added_npm", Domain::kAny, Strength::kTimes,
        [](const SimulationConfig& config) { return 0.3 * config.truck.stiffness_npm; },
        [](SimulationConfig& config, double value) {
          config.truck.stiffness.asymmetry_npm = value;
        }}}};
  return {"asymmetric_stiffness", "more stiffness for y > 0 only", kParameters};
}

}  // namespace dampline::sim

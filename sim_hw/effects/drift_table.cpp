// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include "sim_hw/effects/tables.hpp"

namespace dampline::sim {
Effect time_drift_effect() noexcept {
  static constexpr std::array<EffectParameter, 5> kParameters{
      {{"friction_factor", Domain::kPositive, Strength::kAboutOne, fixed<700000>,
        [](SimulationConfig& config, double value) { config.truck.drift.friction_factor = value; }},
       {"stiffness_factor", Domain::kPositive, Strength::kAboutOne, fixed<1000000>,
        [](SimulationConfig& config, double value) {
          config.truck.drift.stiffness_factor = value;
        }},
       {"mass_factor", Domain::kPositive, Strength::kAboutOne, fixed<1000000>,
        [](SimulationConfig& config, double value) { config.truck.drift.mass_factor = value; }},
       {"start_s", Domain::kAny, Strength::kNone, fixed<150000000>,
        [](SimulationConfig& config, double value) { config.truck.drift.start_s = value; }},
       {"end_s", Domain::kAny, Strength::kNone, fixed<150000000>,
        [](SimulationConfig& config, double value) { config.truck.drift.end_s = value; }}}};
  return {"time_drift",
          "friction, stiffness and mass reach these factors at end, linearly from start; a step "
          "where end <= start",
          kParameters};
}

Effect unmodelled_mode_effect() noexcept {
  static constexpr std::array<EffectParameter, 5> kParameters{
      {{"pitch_inertia_kgm2", Domain::kNotNegative, Strength::kNone, fixed<1500000000>,
        [](SimulationConfig& config, double value) {
          config.truck.modes.pitch_inertia_kgm2 = value;
        }},
       {"pitch_half_wheelbase_m", Domain::kPositive, Strength::kNone, fixed<900000>,
        [](SimulationConfig& config, double value) {
          config.truck.modes.pitch_half_wheelbase_m = value;
        }},
       {"flexible_share", Domain::kNotNegative, Strength::kNone, fixed<0>,
        [](SimulationConfig& config, double value) {
          config.truck.modes.flexible_share = std::min(value, 0.95);
        }},
       {"flexible_frequency_hz", Domain::kPositive, Strength::kNone, fixed<9000000>,
        [](SimulationConfig& config, double value) {
          config.truck.modes.flexible_frequency_hz = value;
        }},
       {"flexible_damping_ratio", Domain::kNotNegative, Strength::kNone, fixed<30000>,
        [](SimulationConfig& config, double value) {
          config.truck.modes.flexible_damping_ratio = value;
        }}}};
  return {"unmodelled_mode", "pitch of the frame (inertia 0: none), flexible body (share 0: none)",
          kParameters};
}

}  // namespace dampline::sim

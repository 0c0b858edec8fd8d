// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include "sim_hw/effects/tables.hpp"

namespace dampline::sim {
namespace {

/// The simulation keeps a short past only.
double skew_s(double wanted_s) noexcept { return std::clamp(wanted_s, -0.02, 0.02); }

}  // namespace

Effect time_skew_effect() noexcept {
  static constexpr std::array<EffectParameter, 3> kParameters{
      {{"frame_s", Domain::kAny, Strength::kTimes, fixed<2000>,
        [](SimulationConfig& config, double value) {
          config.sensors.time_skew_s[0] = skew_s(value);
        }},
       {"wheelset1_s", Domain::kAny, Strength::kTimes, fixed<0>,
        [](SimulationConfig& config, double value) {
          config.sensors.time_skew_s[1] = skew_s(value);
        }},
       {"wheelset2_s", Domain::kAny, Strength::kTimes, fixed<0>,
        [](SimulationConfig& config, double value) {
          config.sensors.time_skew_s[2] = skew_s(value);
        }}}};
  return {"time_skew", "channels that show the past (positive) or the future, 20 ms at most",
          kParameters};
}

Effect gain_error_effect() noexcept {
  static constexpr std::array<EffectParameter, 3> kParameters{
      {{"frame", Domain::kAny, Strength::kTimes, fixed<0>,
        [](SimulationConfig& config, double value) { config.sensors.gain_error[0] = value; }},
       {"wheelset1", Domain::kAny, Strength::kTimes, fixed<50000>,
        [](SimulationConfig& config, double value) { config.sensors.gain_error[1] = value; }},
       {"wheelset2", Domain::kAny, Strength::kTimes, fixed<0>,
        [](SimulationConfig& config, double value) { config.sensors.gain_error[2] = value; }}}};
  return {"gain_error", "relative errors of the sensitivities", kParameters};
}

Effect cross_axis_effect() noexcept {
  static constexpr std::array<EffectParameter, 4> kParameters{
      {{"frame_rad", Domain::kAny, Strength::kTimes, fixed<100000>,
        [](SimulationConfig& config, double value) { config.sensors.tilt_rad[0] = value; }},
       {"wheelset1_rad", Domain::kAny, Strength::kTimes, fixed<0>,
        [](SimulationConfig& config, double value) { config.sensors.tilt_rad[1] = value; }},
       {"wheelset2_rad", Domain::kAny, Strength::kTimes, fixed<0>,
        [](SimulationConfig& config, double value) { config.sensors.tilt_rad[2] = value; }},
       {"lateral_mps2", Domain::kNotNegative, Strength::kNone, fixed<600000>,
        [](SimulationConfig& config, double value) { config.sensors.lateral_mps2 = value; }}}};
  return {"cross_axis", "tilted sensors that see a lateral acceleration", kParameters};
}

Effect impulsive_input_effect() noexcept {
  static constexpr std::array<EffectParameter, 8> kParameters{
      {{"shock_force_n", Domain::kNotNegative, Strength::kTimes,
        [](const SimulationConfig& config) { return 3.0 * coulomb_level_n(config); },
        [](SimulationConfig& config, double value) { config.impulses.shock_force_n = value; }},
       {"shock_rate_hz", Domain::kPositive, Strength::kNone, fixed<200000>,
        [](SimulationConfig& config, double value) { config.impulses.shock_rate_hz = value; }},
       {"shock_duration_s", Domain::kPositive, Strength::kNone, fixed<20000>,
        [](SimulationConfig& config, double value) { config.impulses.shock_duration_s = value; }},
       {"joint_depth_m", Domain::kNotNegative, Strength::kNone, fixed<0>,
        [](SimulationConfig& config, double value) { config.impulses.joint_depth_m = value; }},
       {"joint_length_m", Domain::kPositive, Strength::kNone, fixed<300000>,
        [](SimulationConfig& config, double value) { config.impulses.joint_length_m = value; }},
       {"joint_spacing_m", Domain::kPositive, Strength::kNone, fixed<25000000>,
        [](SimulationConfig& config, double value) { config.impulses.joint_spacing_m = value; }},
       {"flat_depth_m", Domain::kNotNegative, Strength::kNone, fixed<0>,
        [](SimulationConfig& config, double value) { config.impulses.flat_depth_m = value; }},
       {"flat_length_m", Domain::kPositive, Strength::kNone, fixed<100000>,
        [](SimulationConfig& config, double value) { config.impulses.flat_length_m = value; }}}};
  return {"impulsive_input",
          "shocks on the frame that no sensor measures; rail joints and a wheel flat, which the "
          "wheelsets measure (depth 0: none)",
          kParameters};
}

}  // namespace dampline::sim

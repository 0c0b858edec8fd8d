// SPDX-License-Identifier: MIT
#include <array>

#include "sim_hw/effects/tables.hpp"

namespace dampline::sim {
Effect coulomb_effect() noexcept {
  static constexpr std::array<EffectParameter, 1> kParameters{
      {{"level_n", Domain::kNotNegative, Strength::kTimes,
        [](const SimulationConfig& config) { return coulomb_level_n(config); },
        [](SimulationConfig& config, double value) {
          config.truck.friction_positive_n = config.truck.friction_negative_n =
              value / config.truck.friction_scale;
        }}}};
  return {"coulomb", "F sign v, alike in both directions", kParameters};
}

Effect asymmetric_coulomb_effect() noexcept {
  static constexpr std::array<EffectParameter, 2> kParameters{
      {{"positive_n", Domain::kNotNegative, Strength::kNone,
        [](const SimulationConfig& config) { return 0.7 * coulomb_level_n(config); },
        [](SimulationConfig& config, double value) {
          config.truck.friction_positive_n = value / config.truck.friction_scale;
        }},
       {"negative_n", Domain::kNotNegative, Strength::kNone,
        [](const SimulationConfig& config) { return 1.3 * coulomb_level_n(config); },
        [](SimulationConfig& config, double value) {
          config.truck.friction_negative_n = value / config.truck.friction_scale;
        }}}};
  return {"asymmetric_coulomb", "F+ for v > 0, F- for v < 0", kParameters};
}

Effect progressive_friction_effect() noexcept {
  static constexpr std::array<EffectParameter, 2> kParameters{
      {{"length_m", Domain::kPositive, Strength::kDivide, fixed<4000>,
        [](SimulationConfig& config, double value) {
          config.truck.damping.progressive_length_m = value;
        }},
       {"absolute", Domain::kNotNegative, Strength::kNone, fixed<0>,
        [](SimulationConfig& config, double value) {
          config.truck.damping.progressive_absolute = value != 0.0;
        }}}};
  return {"progressive_friction",
          "friction times 1 + y / length, never below 0; absolute=1: 1 + |y| / length",
          kParameters};
}

Effect stribeck_effect() noexcept {
  static constexpr std::array<EffectParameter, 2> kParameters{
      {{"share", Domain::kAny, Strength::kTimes, fixed<400000>,
        [](SimulationConfig& config, double value) {
          config.truck.damping.stribeck_share = value;
        }},
       {"speed_mps", Domain::kPositive, Strength::kNone, fixed<10000>,
        [](SimulationConfig& config, double value) {
          config.truck.damping.stribeck_speed_mps = value;
        }}}};
  return {"stribeck", "friction times 1 + share exp(-|v| / speed)", kParameters};
}

Effect presliding_hysteresis_effect() noexcept {
  static constexpr std::array<EffectParameter, 1> kParameters{
      {{"distance_m", Domain::kPositive, Strength::kTimes, fixed<150>,
        [](SimulationConfig& config, double value) {
          config.truck.hysteresis.presliding_distance_m = value;
        }}}};
  return {"presliding_hysteresis", "friction builds up over a distance after each reversal (Dahl)",
          kParameters};
}

Effect backlash_effect() noexcept {
  static constexpr std::array<EffectParameter, 1> kParameters{
      {{"gap_m", Domain::kPositive, Strength::kTimes, fixed<300>,
        [](SimulationConfig& config, double value) {
          config.truck.hysteresis.backlash_gap_m = value;
        }}}};
  return {"backlash", "no friction until a gap is taken up after each reversal", kParameters};
}

}  // namespace dampline::sim

// SPDX-License-Identifier: MIT
#include <array>

#include "sim_hw/effects/tables.hpp"

namespace dampline::sim {

std::span<const Effect> effect_table() noexcept {
  static const std::array table{viscous_effect(),
                                asymmetric_viscous_effect(),
                                quadratic_damping_effect(),
                                coulomb_effect(),
                                asymmetric_coulomb_effect(),
                                offset_force_effect(),
                                progressive_friction_effect(),
                                stribeck_effect(),
                                presliding_hysteresis_effect(),
                                backlash_effect(),
                                bump_stop_effect(),
                                cubic_stiffness_effect(),
                                quadratic_stiffness_effect(),
                                asymmetric_stiffness_effect(),
                                time_drift_effect(),
                                unmodelled_mode_effect(),
                                time_skew_effect(),
                                gain_error_effect(),
                                cross_axis_effect(),
                                impulsive_input_effect()};
  return table;
}

}  // namespace dampline::sim

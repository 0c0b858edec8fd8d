// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <string_view>

namespace dampline::app {

/// Names of the physical effects that a model may contain or lack.
inline constexpr std::array<std::string_view, 21> kEffects{"viscous",
                                                           "asymmetric_viscous",
                                                           "quadratic_damping",
                                                           "coulomb",
                                                           "asymmetric_coulomb",
                                                           "offset_force",
                                                           "progressive_friction",
                                                           "stribeck",
                                                           "presliding_hysteresis",
                                                           "backlash",
                                                           "bump_stop",
                                                           "cubic_stiffness",
                                                           "quadratic_stiffness",
                                                           "time_drift",
                                                           "unmodelled_mode",
                                                           "time_skew",
                                                           "gain_error",
                                                           "cross_axis",
                                                           "asymmetric_stiffness",
                                                           "impulsive_input",
                                                           "all"};

}  // namespace dampline::app

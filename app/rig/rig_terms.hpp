// SPDX-License-Identifier: MIT
#pragma once
#include "app/config/config.hpp"
#include "dampline/rig/rig_config.hpp"

namespace dampline::app {

/// The terms of a rig's force from [model]: base, inertia, stiffness. "auto" means no spring: a
/// force cell on a damper measures the damper alone, and friction with memory would pass for a
/// spring. Throws UsageError naming the effect that cannot be identified from a rig, or effects
/// that exclude each other.
[[nodiscard]] RigTerms rig_terms(const ModelConfig& model);

/// Effect names of the terms, the linear ones first: "moving_mass", "linear spring", "coulomb", ...
[[nodiscard]] std::vector<std::string> term_names(const RigTerms& terms);

}  // namespace dampline::app

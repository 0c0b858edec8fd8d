// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/diagnosis/rig/rig_series.hpp"

namespace dampline::app {

/// Whether an inertia takes most of what a spring and friction leave of the force: the force moves
/// a mass, and is not that of a damper whose motion is prescribed.
[[nodiscard]] bool is_driven_mass(const std::vector<RigSeries>& records);

}  // namespace dampline::app

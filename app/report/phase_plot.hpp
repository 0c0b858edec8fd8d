// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "dampline/phase/view.hpp"

namespace dampline::app {

/// The three planes of the extended phase space as one <svg> element: densities, axes with units,
/// and the section points over them. A plane without a picture says why. `name` keeps the
/// identifiers of several drawings on one page apart.
[[nodiscard]] std::string plot_phase(const PhaseSnapshot& snapshot, const std::string& name);

/// What the sections show, or why there are none, in one plain sentence.
[[nodiscard]] std::string describe_period(const PhaseSnapshot& snapshot);

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/report/plots.hpp"
#include "dampline/phase/view.hpp"

namespace dampline::app {

/// The three planes of the extended phase space: densities and the section points over them. A
/// plane without a picture says why.
[[nodiscard]] Plot plot_phase(const PhaseSnapshot& snapshot);

/// What the sections show, or why there are none, in one plain sentence.
[[nodiscard]] std::string describe_period(const PhaseSnapshot& snapshot);

}  // namespace dampline::app

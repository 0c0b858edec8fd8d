// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/report/plots.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// One row per fault and channel over the whole record: what it spoils, and where it was seen.
[[nodiscard]] PlotScript plot_faults(const RunResult& result);
/// Faults with channel, time and size, inputs that are no faults, and a parameter that changed, as
/// HTML. Empty for a rig's record.
[[nodiscard]] std::string fault_section(const RunResult& result);

}  // namespace dampline::app

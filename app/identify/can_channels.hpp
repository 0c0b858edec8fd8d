// SPDX-License-Identifier: MIT
#pragma once
#include "app/config/config.hpp"
#include "dampline/sample/assembler.hpp"

namespace dampline::app {

/// The three channels as the DBC file of the configuration describes them; without one, the
/// project's own sensors. Throws UsageError naming file and signal.
[[nodiscard]] AssemblerConfig can_channels(const Config& config);

}  // namespace dampline::app

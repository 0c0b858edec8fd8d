// SPDX-License-Identifier: MIT
#pragma once
#include <array>

#include "app/config/config.hpp"
#include "dampline/sample/assembler.hpp"
#include "dampline/sample/screen.hpp"

namespace dampline::app {

/// The three channels as the DBC file of the configuration describes them; without one, the
/// project's own sensors. Throws UsageError naming file and signal.
[[nodiscard]] AssemblerConfig can_channels(const Config& config);

/// What the channels' signals tell the screen beforehand: their resolution.
[[nodiscard]] ScreenConfig screen_of(const std::array<ChannelConfig, kChannels>& channels);

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "app/config/config.hpp"
#include "app/live/recorder.hpp"
#include "hal/clock.hpp"
#include "hal/digital_output.hpp"
#include "hal/edge_source.hpp"

namespace dampline::app {

/// "marker:4:active_low" of [gpio] edges.
enum class LineUse : std::uint8_t { kPulse, kMarker, kWheel };
struct LineSetting {
  LineUse use{LineUse::kPulse};
  unsigned offset{0};
  bool active_low{false};
};
/// Throws UsageError naming the key and the text.
[[nodiscard]] LineSetting parse_edge_setting(const std::string& text);
/// "7" or "7:active_low" of [gpio] lamp; its use means nothing. Throws UsageError.
[[nodiscard]] LineSetting parse_lamp_setting(const std::string& text);

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/outcome.hpp"
#include "hal/clock.hpp"
#include "hal/digital_output.hpp"
#include "hal/edge_source.hpp"

namespace dampline::drivers {

struct EdgeLine {
  unsigned offset{0};      ///< number of the line on its chip
  bool active_low{false};  ///< then a falling voltage is a rising edge
  bool rising{true};       ///< watch inactive to active
  bool falling{true};      ///< watch active to inactive; both watched are checked to alternate
};

struct EdgeConfig {
  std::string chip;             ///< path of its device, or name under /dev
  std::vector<EdgeLine> lines;  ///< hal::Edge::line counts in this order; at most 64
  hal::RunTime run_time;
};

struct OutputConfig {
  std::string chip;
  unsigned offset{0};
  bool active_low{false};
};

// One of three files holds these, as the build found the library: v1.cpp, v2.cpp, or
// none.cpp, where opening always fails and says so.

/// Lost edges: counted by libgpiod 2; libgpiod 1 keeps 16 a line and cannot tell of more.
[[nodiscard]] Outcome<std::unique_ptr<hal::EdgeSource>> open_edges(const EdgeConfig& config);
/// Inactive when opened.
[[nodiscard]] Outcome<std::unique_ptr<hal::DigitalOutput>> open_output(const OutputConfig& config);
/// Name and version of the library in use.
[[nodiscard]] std::string gpio_library();

}  // namespace dampline::drivers

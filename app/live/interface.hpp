// SPDX-License-Identifier: MIT
#pragma once
#include <filesystem>
#include <string>

#include "app/config/config.hpp"
#include "app/identify/source.hpp"
#include "app/live/run.hpp"

namespace dampline::app {

struct LivePlace {
  std::filesystem::path run;        ///< where live.json is kept up to date
  std::filesystem::path blackbox;   ///< empty: nothing is recorded
  std::filesystem::path status;     ///< a copy of live.json where it stays the same; or empty
  std::filesystem::path metrics{};  ///< Prometheus text for node_exporter; or empty
  bool show_progress{false};        ///< a line on the terminal
};

/// Identifies a CAN interface until a signal or the end of the duration. Constructs the drivers.
/// Throws UsageError for a wrong configuration, RunError when a driver cannot be opened or nothing
/// could be identified.
[[nodiscard]] Identified identify_live(const Config& config, const std::string& interface,
                                       const LiveOptions& options, const LivePlace& place);

}  // namespace dampline::app

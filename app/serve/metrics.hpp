// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>

#include "app/run/result.hpp"

namespace dampline::app {

/// What a server knows of itself.
struct ServerFigures {
  std::uint64_t requests{0};
  std::uint64_t readers{0};      ///< of the stream of events, now
  std::uint64_t motion_lost{0};  ///< samples that the page's pictures lack
};

/// A live result as Prometheus reads it, version 0.0.4 of its text: for each metric HELP, TYPE and
/// its values. Durations are in seconds; a number that is not finite is left out. `server`: null in
/// a file.
[[nodiscard]] std::string metrics_text(const RunResult& result, const ServerFigures* server);

}  // namespace dampline::app

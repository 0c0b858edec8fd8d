// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/config/config.hpp"
#include "app/live/acquisition.hpp"
#include "app/live/condition.hpp"
#include "app/live/realtime.hpp"
#include "app/run/result.hpp"
#include "hal/record_sink.hpp"

namespace dampline::app {

/// What surrounds a status: all that live.json and the report tell of a live run.
struct LiveSurroundings {
  std::string source;  ///< "can0"
  Realtime realtime;
  hal::RecordHealth record;
  bool record_wanted{true};
  std::string state;
  std::int64_t start_ns{0};  ///< monotonic
  std::int64_t silence_ns{0};
};

/// The live figures and what a reader must know of them; adds to a result of whatever kind.
void describe_live(const LiveStatus& status, const LiveSurroundings& around, RunResult& result);

/// A result in the middle of a run, with what is known by now. Never throws for too little data:
/// then it holds counts and says so.
[[nodiscard]] RunResult live_result(const LiveStatus& status, const LiveSurroundings& around,
                                    const Config& config);

/// One line for a terminal or the service manager.
[[nodiscard]] std::string status_line(const RunResult& result);

}  // namespace dampline::app

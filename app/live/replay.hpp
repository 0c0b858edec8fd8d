// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/config/config.hpp"
#include "app/record/feed.hpp"
#include "app/record/source_kind.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

struct ReplayOptions {
  double speed{1.0};  ///< times real time; 0: as fast as it goes
  /// Of the clock on the wall; 0: 10 s of the record, but 0.5 to 10 s.
  double publish_every_s{0.0};
  bool end{false};  ///< with the record, not on a signal
  bool show_progress{false};
};

/// A truck's record as a live run shows it: identified at `speed` and served as [serve] says, with
/// the alarms of [alarm], which start no program here. The end of the record is shown until a
/// signal. Gives the last result. Throws UsageError or RunError, as a live run does.
[[nodiscard]] RunResult replay(const Config& config, const SourceOptions& source, SourceKind kind,
                               const ReplayOptions& options);

}  // namespace dampline::app

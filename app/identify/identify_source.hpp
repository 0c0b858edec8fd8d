// SPDX-License-Identifier: MIT
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/identify/sample_feed.hpp"
#include "app/identify/source_kind.hpp"
#include "app/identify/truck_run.hpp"
#include "app/run/checksum.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

struct Identified {
  RunResult result;
  std::string state;  ///< for state.dls; empty for a rig
  std::vector<InputFile> inputs;
};

/// Opens a truck's record. Throws RunError.
[[nodiscard]] std::unique_ptr<SampleFeed> open_feed(const Config& config,
                                                    const SourceOptions& source, SourceKind kind);

/// Every sample of `feed` through `run`. `state` tells of the run in the progress line. Throws
/// RunError when the record holds no complete sample.
void pump(SampleFeed& feed, const SourceOptions& source, bool show_progress,
          const std::function<std::string(const TruckRun&)>& state, TruckRun& run);

/// Opens a record, live interfaces excepted, and identifies it. Throws RunError or UsageError;
/// there is no partial result.
[[nodiscard]] Identified identify_source(const Config& config, const SourceOptions& source,
                                         SourceKind kind, bool show_progress);

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/identify/sample_feed.hpp"
#include "app/identify/source_kind.hpp"
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

/// Opens a record, live interfaces excepted, and identifies it. Throws RunError or UsageError;
/// there is no partial result.
[[nodiscard]] Identified identify_source(const Config& config, const SourceOptions& source,
                                         SourceKind kind, bool show_progress);

}  // namespace dampline::app

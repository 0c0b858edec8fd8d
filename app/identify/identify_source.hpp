// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/error.hpp"
#include "app/identify/progress.hpp"
#include "app/identify/sample_feed.hpp"
#include "app/identify/source_kind.hpp"
#include "app/identify/truck_run.hpp"
#include "app/run/provenance.hpp"
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

/// By the rows' own time, or by the frames'.
template <Parts kParts>
[[nodiscard]] MeasuredRate rate_of(const SampleFeed& feed, const TruckRun<kParts>& run) {
  return feed.rate().value_or(run.core().assembler().measured_rate());
}

/// Everything of `feed` through `run`. Throws RunError when the record holds no complete sample.
template <Parts kParts>
void pump(SampleFeed& feed, const SourceOptions& source, bool show_progress,
          TruckRun<kParts>& run) {
  const auto lines = show_progress ? estimate_lines(source.path) : std::nullopt;
  Progress progress{show_progress};
  for (bool more = true; more;) {
    const Batch batch = feed.read();
    for (const CanFrame& frame : batch.frames) run.take(frame);
    for (const Sample& sample : batch.samples) run.take(sample);
    more = batch.more;
    if (!progress.due()) continue;
    const auto share =
        lines ? std::optional{static_cast<double>(feed.lines()) / *lines} : std::nullopt;
    progress.show(share, run.time_s(), run.state_text());
  }
  run.flush();
  if (run.empty())
    throw RunError{fmt::format("{}: holds no complete sample: {}", source.path,
                               feed.explain_emptiness(run.frames()))};
}

/// Opens a record, live interfaces excepted, and identifies it. Throws RunError or UsageError;
/// there is no partial result.
[[nodiscard]] Identified identify_source(const Config& config, const SourceOptions& source,
                                         SourceKind kind, bool show_progress);

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/error.hpp"
#include "app/identify/truck_run.hpp"
#include "app/live/process.hpp"
#include "app/record/feed.hpp"
#include "app/record/source_kind.hpp"
#include "app/run/provenance.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// One line on a terminal that is written over and over; nothing anywhere else. Shows how much is
/// done and how much faster than real time.
class Progress {
 public:
  /// `enabled` false: every call does nothing.
  explicit Progress(bool enabled);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  /// Whether a line is due; asks a clock, so call it once per batch.
  [[nodiscard]] bool due();
  /// `share` of the work done, 0...1, where it is known; `time_s` in the record, 0 where that
  /// means nothing; `state` is what is
  /// known so far.
  void show(std::optional<double> share, double time_s, const std::string& state);
  /// Takes the line away.
  void clear();

 private:
  bool enabled_;
  bool shown_{false};
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point next_;
};

struct Identified {
  RunResult result;
  std::shared_ptr<const Statistics> sums;  ///< null for a rig
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

/// When a pipe is over: at its end, or after a signal, when what its writer had still in hand is
/// read.
class PipeEnd {
 public:
  /// `path`: a regular file and a black box end by themselves; a signal ends the program then.
  explicit PipeEnd(const std::string& path);
  /// After each batch; an empty one was waited for.
  [[nodiscard]] bool reached(bool empty) noexcept;
  [[nodiscard]] bool by_signal() const noexcept { return stop_ && stop_->made(); }

 private:
  std::optional<StopRequest> stop_;
  int batches_{0};  // since the signal
  int empty_{0};    // in a row
};

/// What `feed` has, at least until `most_s` of it are used, through `run`. Throws RunError when the
/// record holds no complete sample.
template <Parts kParts>
void pump(SampleFeed& feed, const SourceOptions& source, bool show_progress, TruckRun<kParts>& run,
          double most_s = std::numeric_limits<double>::infinity()) {
  Progress progress{show_progress};
  PipeEnd end{source.path};
  for (bool more = true; more;) {
    const Batch batch = feed.read();
    for (const CanFrame& frame : batch.frames) run.take(frame);
    for (const Sample& sample : batch.samples) run.take(sample);
    more = batch.more && !end.reached(batch.frames.empty() && batch.samples.empty()) &&
           run.used_s() < most_s;
    if (!progress.due()) continue;
    progress.show(feed.share_read(), run.time_s(), run.state_text());
  }
  run.flush();
  if (run.empty())
    throw RunError{fmt::format("{}: holds no complete sample: {}", source.path,
                               feed.explain_emptiness(run.frames()))};
}

/// A truck's record alone, without its checksum; no more than until `most_s` of it are used.
/// Throws RunError or UsageError.
[[nodiscard]] Identified identify_truck(const Config& config, const SourceOptions& source,
                                        SourceKind kind, bool show_progress,
                                        double most_s = std::numeric_limits<double>::infinity());

/// Opens a record, live interfaces excepted, and identifies it. Throws RunError or UsageError;
/// there is no partial result.
[[nodiscard]] Identified identify_source(const Config& config, const SourceOptions& source,
                                         SourceKind kind, bool show_progress);

}  // namespace dampline::app

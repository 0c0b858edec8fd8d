// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/run/provenance.hpp"
#include "app/run/result.hpp"
#include "dampline/can_frame.hpp"
#include "dampline/sample.hpp"
#include "dampline/sample/assembler.hpp"
#include "dampline/sample/screen.hpp"
#include "dampline/sample/ticks.hpp"

namespace dampline::app {

/// What a source tells of its channels: where they stand in frames, if it has frames, and their
/// resolution.
struct RecordSignals {
  std::array<ChannelConfig, kChannels> channels{};
  ScreenConfig screen{};  ///< its rate is the configuration's
  ExtraSignals extras{};
};

/// What a source handed over: frames to be decoded, or samples as rows hold them. Valid until the
/// next read().
struct Batch {
  std::span<const CanFrame> frames{};
  std::span<const Sample> samples{};
  bool more{true};  ///< false: there will be no more
};

/// What a run knows of the frames that a source gave it.
struct FrameSummary {
  AssemblerCounts counts;
  std::int64_t first_time_ns{0};  ///< of the first sample
};

/// Where a truck record comes from. read() throws RunError with file and line.
class SampleFeed {
 public:
  SampleFeed() = default;
  SampleFeed(const SampleFeed&) = delete;
  SampleFeed& operator=(const SampleFeed&) = delete;
  virtual ~SampleFeed() = default;
  /// The next batch. An empty one with more to come: a pipe has nothing yet, and a while was
  /// waited.
  virtual Batch read() = 0;
  /// What is known of the channels beforehand.
  [[nodiscard]] virtual RecordSignals signals() const = 0;
  /// Of rows; none where the corridor itself measures the rate of the frames.
  [[nodiscard]] virtual std::optional<MeasuredRate> rate() const { return std::nullopt; }
  /// Of the record, 0...1, for the progress line; none where nobody knows.
  [[nodiscard]] virtual std::optional<double> share_read() const { return std::nullopt; }
  /// For an error message when not one sample came: what there was instead.
  [[nodiscard]] virtual std::string explain_emptiness(const FrameSummary& frames) const = 0;
  /// Adds what only the source knows: its counts, and notes for the reader of the report.
  virtual void describe(const FrameSummary& frames, RunResult& result) const = 0;
  /// Files beside the record that went in (a DBC file).
  [[nodiscard]] virtual std::vector<InputFile> extra_inputs() const { return {}; }
};

struct SourceOptions {
  std::string path;  ///< "-": standard input
  bool skip_bad_lines{false};
};

/// CAN frames of a recording of any format, decoded through the DBC file of the configuration.
[[nodiscard]] std::unique_ptr<SampleFeed> open_can_feed(const Config& config,
                                                        const SourceOptions& source);
/// CAN frames as a live run recorded them.
[[nodiscard]] std::unique_ptr<SampleFeed> open_blackbox_feed(const Config& config,
                                                             const SourceOptions& source);
/// Rows of a table or of arrays with a truck's three accelerations.
[[nodiscard]] std::unique_ptr<SampleFeed> open_csv_feed(const Config& config,
                                                        const SourceOptions& source);

}  // namespace dampline::app

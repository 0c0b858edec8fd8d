// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/run/checksum.hpp"
#include "app/run/result.hpp"
#include "dampline/sample.hpp"
#include "dampline/sample/screen.hpp"
#include "dampline/sample/ticks.hpp"

namespace dampline::app {

/// Where the samples of a truck record come from. read() throws RunError with file and line.
class SampleFeed {
 public:
  SampleFeed() = default;
  SampleFeed(const SampleFeed&) = delete;
  SampleFeed& operator=(const SampleFeed&) = delete;
  virtual ~SampleFeed() = default;
  /// Appends a batch of samples; false when there will be no more. None and true: a pipe has
  /// nothing yet, and a while was waited.
  virtual bool read(std::vector<Sample>& out) = 0;
  [[nodiscard]] virtual MeasuredRate rate() const = 0;
  /// What is known of the channels beforehand: their resolution, whether full scale is known.
  [[nodiscard]] virtual ScreenConfig screen() const = 0;
  /// Lines read so far, for the progress line.
  [[nodiscard]] virtual std::uint64_t lines() const = 0;
  /// For an error message when not one sample came: what there was instead.
  [[nodiscard]] virtual std::string explain_emptiness() const = 0;
  /// Adds what only the source knows: its counts, and notes for the reader of the report.
  virtual void describe(RunResult& result) const = 0;
  /// Files beside the record that went in (a DBC file).
  [[nodiscard]] virtual std::vector<InputFile> extra_inputs() const { return {}; }
};

struct SourceOptions {
  std::string path;  ///< "-": standard input
  bool skip_bad_lines{false};
};

/// CAN frames of a candump log, decoded through the DBC file of the configuration.
[[nodiscard]] std::unique_ptr<SampleFeed> open_can_feed(const Config& config,
                                                        const SourceOptions& source);
/// CAN frames as a live run recorded them.
[[nodiscard]] std::unique_ptr<SampleFeed> open_blackbox_feed(const Config& config,
                                                             const SourceOptions& source);
/// Rows of a CSV file with a truck's three accelerations.
[[nodiscard]] std::unique_ptr<SampleFeed> open_csv_feed(const Config& config,
                                                        const SourceOptions& source);

}  // namespace dampline::app

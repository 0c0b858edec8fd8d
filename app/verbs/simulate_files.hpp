// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "app/verbs/text_file.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {

/// The truth of a run as CSV, where it was asked for.
class TruthFile {
 public:
  /// An empty path: none. Throws RunError.
  TruthFile(const std::string& path, const sim::SimulationConfig& config);
  void append(const sim::SimulatedSample& sample);
  void close();

 private:
  std::optional<TextFile> file_;
};

/// A line on a terminal that shows how far the run is, at most once per percent.
class SimulateProgress {
 public:
  SimulateProgress(std::int64_t samples, bool quiet);
  void at(std::int64_t sample) const;
  void end() const;

 private:
  std::int64_t step_;
  bool shown_;
};

}  // namespace dampline::app

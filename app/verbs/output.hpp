// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "app/run/disk.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {

/// A text file that is written front to back through a large buffer; "-" is the standard output.
/// A file appears whole, when it is closed.
class TextFile {
 public:
  /// Throws UsageError where the file exists and is not to be replaced, RunError naming the file
  /// and the reason.
  TextFile(std::string path, bool replace);
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  ~TextFile();
  /// Append here, then call tick() now and then.
  [[nodiscard]] fmt::memory_buffer& buffer() noexcept { return buffer_; }
  /// Writes the buffer out when it has grown. Throws RunError when the disk is full.
  void tick() {
    if (buffer_.size() >= kFlushBytes) flush();
  }
  /// Writes the rest, and the file is there. Throws RunError.
  void close() {
    finish();
    appear();
  }
  /// The two steps of close(), for several files that are there together or not at all.
  void finish();
  void appear();
  /// After appear(): takes a new file away again.
  void withdraw() const noexcept;

 private:
  static constexpr std::size_t kFlushBytes = std::size_t{1} << 20U;
  void open_there();
  void open_beside();
  void flush();
  [[noreturn]] void fail(const char* action) const;
  [[nodiscard]] bool is_stdout() const noexcept { return path_ == "-"; }
  std::string path_;
  Descriptor folder_;
  std::string staged_;  ///< its name in the folder until it is whole; empty: written where it is
  bool replace_;
  bool is_new_{false};  ///< there was none of its name
  int file_{-1};
  fmt::memory_buffer buffer_;
};

/// The truth of a run as CSV, where it was asked for.
class TruthFile {
 public:
  /// An empty path: none. Throws RunError.
  TruthFile(const std::string& path, const sim::SimulationConfig& config, bool replace);
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

// SPDX-License-Identifier: MIT
#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

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

/// How many lines a text file may have, judged by its first ones. Absent for what is no regular
/// file.
[[nodiscard]] std::optional<double> estimate_lines(const std::string& path);

}  // namespace dampline::app

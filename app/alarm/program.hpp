// SPDX-License-Identifier: MIT
#pragma once
#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "app/alarm/alarms.hpp"

namespace dampline::app {

/// The program of [alarm] on_alarm: started at each change with its own arguments and behind them
/// NAME, "raised" or "cleared", VALUE, LIMIT, UNIT, SECONDS; what is not known is "-". No shell
/// reads them. It is not waited for; at most kMostRunning run at once, what comes beyond is
/// counted.
class AlarmProgram {
 public:
  static constexpr std::size_t kMostRunning = 8;

  /// `command`: the program's path and its own arguments; empty: nothing is started. Throws
  /// UsageError where the path is not absolute or nothing that can be run.
  explicit AlarmProgram(std::vector<std::string> command);
  AlarmProgram(const AlarmProgram&) = delete;
  AlarmProgram& operator=(const AlarmProgram&) = delete;
  ~AlarmProgram() = default;

  /// False where it could not be started.
  bool start(const AlarmChange& change, double now_s);
  /// Call some times a second: takes note of those that have ended.
  void collect() noexcept;
  [[nodiscard]] std::uint64_t failures() const noexcept { return failures_; }
  [[nodiscard]] std::size_t running() const noexcept { return running_.size(); }

 private:
  std::vector<std::string> command_;
  std::vector<pid_t> running_;
  std::uint64_t failures_{0};
};

}  // namespace dampline::app

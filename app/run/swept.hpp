// SPDX-License-Identifier: MIT
#pragma once
#include <csignal>
#include <filesystem>
#include <vector>

namespace dampline::app {

/// Folders that are removed, where they are empty, when SIGINT, SIGTERM or SIGHUP ends the program
/// while this object lives. A handler that somebody else has set stays; of several objects the
/// first one counts.
class SweptOnSignal {
 public:
  /// `folders`: the inner ones first.
  explicit SweptOnSignal(const std::vector<std::filesystem::path>& folders);
  SweptOnSignal(const SweptOnSignal&) = delete;
  SweptOnSignal& operator=(const SweptOnSignal&) = delete;
  ~SweptOnSignal();

 private:
  bool first_{false};
};

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

namespace dampline::app {

struct ChildResult {
  bool started{false};  ///< false: there is no such program
  int status{-1};       ///< exit code; 128 + signal when killed
  std::string output;
  std::string error;
};

/// Runs a program found in PATH with `input` on its standard input and waits for its end. No shell.
/// Throws RunError when the system cannot (no temporary file, no process).
[[nodiscard]] ChildResult run_child(const std::vector<std::string>& command,
                                    const std::string& input);

}  // namespace dampline::app

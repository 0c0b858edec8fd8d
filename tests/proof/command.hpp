// SPDX-License-Identifier: MIT
#pragma once
#include <string>

namespace dampline::proof {

struct CommandResult {
  int status;          ///< exit status; -1: not started or ended by a signal
  std::string output;  ///< standard output
};

/// Runs a shell command and waits for it.
[[nodiscard]] CommandResult run_command(const std::string& command);

}  // namespace dampline::proof

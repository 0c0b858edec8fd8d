// SPDX-License-Identifier: MIT
#pragma once
#include <stdexcept>
#include <string>

namespace dampline::app {

/// The run failed: exit code 1. The text names the file, line or field, what was found and what was
/// expected.
struct RunError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The file system refused: what another place, or more space, may cure.
struct IoError : RunError {
  IoError(const std::string& text, int number) : RunError{text}, error{number} {}
  int error;  ///< errno
};

/// Who reads the standard output has gone: nothing to tell.
struct ClosedPipe : RunError {
  using RunError::RunError;
};

/// Wrong usage or configuration: exit code 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace dampline::app

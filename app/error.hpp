// SPDX-License-Identifier: MIT
#pragma once
#include <stdexcept>

namespace dampline::app {

/// The run failed: exit code 1. The text names the file, line or field, what was found and what was
/// expected.
struct RunError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Wrong usage or configuration: exit code 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace dampline::app

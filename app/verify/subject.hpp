// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

namespace dampline::app {

struct VerifyOptions {
  bool json{false};                   ///< the figures as data
  bool markdown{false};               ///< the figures as Markdown tables
  bool quiet{false};                  ///< nothing on standard output; the exit code tells
  std::vector<std::string> tables{};  ///< only these tables of the publication; empty: all
};

/// One published method whose cases the program recomputes.
struct VerifySubject {
  const char* name;
  const char* meaning;  ///< one line for --help
  /// Recomputes and prints; 0 when every figure is met, otherwise 1. Throws RunError, UsageError.
  int (*run)(const VerifyOptions&);
};

}  // namespace dampline::app

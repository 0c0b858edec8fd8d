// SPDX-License-Identifier: MIT
#pragma once
#include <string>

namespace dampline::app::fleet::page {

struct FleetServerSettings {
  std::string database;
  std::string address;
  std::string token_file;  ///< empty: for a loopback address alone
};

/// Serves page, cars, tables and metrics until a signal. A database that goes is an answer 503
/// until it is back. Throws UsageError for a wrong address, RunError where it cannot be had.
void serve_fleet(const FleetServerSettings& settings);

}  // namespace dampline::app::fleet::page

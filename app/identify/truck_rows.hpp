// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "app/config/config.hpp"
#include "app/identify/sample_feed.hpp"
#include "dampline/sample.hpp"
#include "drivers/csv/reader.hpp"

namespace dampline::app {

/// Rows of a CSV file with a truck's time (s) and three accelerations (m/s^2). Throws RunError with
/// file and line.
class TruckRows {
 public:
  using Row = std::array<double, 1 + kChannels>;

  TruckRows(const InputConfig& input, const SourceOptions& source);

  /// The record's own rate by the time of its first rows, which are still handed on; 0: too few.
  [[nodiscard]] double first_rate_hz() const;
  /// Appends a batch; false at the end.
  bool read(std::vector<Row>& out);
  [[nodiscard]] const drivers::CsvReader& reader() const noexcept { return *reader_; }

 private:
  bool read_batch(std::vector<Row>& out);

  Row scale_{};
  std::unique_ptr<drivers::CsvReader> reader_;
  std::vector<double> values_;
  std::vector<Row> first_;  // read but not yet handed on
};

}  // namespace dampline::app

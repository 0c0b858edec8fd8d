// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <span>

#include "app/config/config.hpp"
#include "app/identify/sample_feed.hpp"
#include "drivers/csv/reader.hpp"

namespace dampline::app {

/// Opens a CSV file for columns by their canonical names, which the configuration may rename. Rows
/// hold the required columns, then the optional ones; factors ([input.scale]) are not applied.
/// Throws RunError naming the file and what is missing.
[[nodiscard]] std::unique_ptr<drivers::CsvReader> open_csv(const InputConfig& input,
                                                           const SourceOptions& source,
                                                           std::span<const Column> required,
                                                           std::span<const Column> optional);

/// Counts and notes that any CSV file gives: skipped lines, columns that were not used, a cut-off
/// end.
void describe_csv(const drivers::CsvReader& reader, RunResult& result);

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/record/feed.hpp"
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

struct RecognisedColumns {
  Config config;                   ///< with [input.columns] and [input.scale] as recognised
  std::vector<std::string> notes;  ///< what was understood, a sentence each
};

/// Columns of a rig's CSV file whose names are not canonical and that the configuration does not
/// name: by the words and the unit in the header, where exactly one fits. Nothing is guessed: a
/// unit that is missing or that contradicts a canonical name throws RunError with the lines that
/// the configuration needs. What is no CSV file, and a truck's record, come back as they are.
[[nodiscard]] RecognisedColumns recognise_columns(const Config& given, const SourceOptions& source);

}  // namespace dampline::app

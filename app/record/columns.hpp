// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/record/feed.hpp"
#include "drivers/record/rows.hpp"

namespace dampline::app {

/// Opens a recording of rows for columns by their canonical names, which the configuration may
/// rename. Rows hold the required columns, then the optional ones; factors ([input.scale]) are not
/// applied. Throws RunError naming the file and what is missing.
[[nodiscard]] std::unique_ptr<drivers::RecordedRows> open_rows(const InputConfig& input,
                                                               const SourceOptions& source,
                                                               std::span<const Column> required,
                                                               std::span<const Column> optional);

/// Counts and notes that any such recording gives: skipped lines, columns that were not used, a
/// cut-off end.
void describe_rows(const drivers::RecordedRows& reader, RunResult& result);

struct RecognisedColumns {
  Config config;                   ///< with [input.columns] and [input.scale] as recognised
  std::vector<std::string> notes;  ///< what was understood, a sentence each
};

/// Columns of a CSV file whose names are not canonical and that the configuration does not name: by
/// the words and the unit in the header, where exactly one fits; of several, the one whose unit is
/// of its kind. Units count for named columns too, unless [input.scale] has a factor. Nothing is
/// guessed: a unit that is missing, of another kind, or that contradicts a canonical name throws
/// RunError with the lines that the configuration needs. What is no CSV file comes back as it is.
[[nodiscard]] RecognisedColumns recognise_columns(const Config& given, const SourceOptions& source);

}  // namespace dampline::app

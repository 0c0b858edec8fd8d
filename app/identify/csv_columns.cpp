// SPDX-License-Identifier: MIT
#include "app/identify/csv_columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/error.hpp"

namespace dampline::app {

std::unique_ptr<drivers::CsvReader> open_csv(const InputConfig& input, const SourceOptions& source,
                                             std::span<const Column> required,
                                             std::span<const Column> optional) {
  drivers::CsvConfig csv;
  csv.path = source.path;
  csv.skip_bad_lines = source.skip_bad_lines;
  csv.time_column = name(Column::kTime);
  for (const Column column : required) csv.required.emplace_back(name(column));
  for (const Column column : optional) csv.optional.emplace_back(name(column));
  for (std::size_t i = 0; i < kColumns; ++i)
    if (!input.columns[i].empty()) csv.renamed[std::string{kColumnNames[i]}] = input.columns[i];
  auto reader = drivers::CsvReader::open(csv);
  if (!reader.ok()) throw RunError{reader.error_text()};
  return std::move(reader.value());
}

void describe_csv(const drivers::CsvReader& reader, RunResult& result) {
  const hal::RowHealth health = reader.health();
  result.counts.insert(result.counts.end(), {{"rows_read", health.rows},
                                             {"lines_malformed", health.malformed},
                                             {"lines_ignored", health.ignored}});
  if (!reader.ignored_columns().empty())
    result.notes.push_back(
        fmt::format("Columns that were not used: {}.", fmt::join(reader.ignored_columns(), ", ")));
  if (health.truncated)
    result.warnings.emplace_back(
        "The file was cut off in the middle of its last line; what is before that "
        "line was used.");
  if (health.malformed > 0)
    result.warnings.push_back(
        fmt::format("{} malformed lines were skipped, as asked for.", health.malformed));
}

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "drivers/record/rows.hpp"
#include "drivers/text/line_reader.hpp"

namespace dampline::drivers {

/// A table in text as a source of rows: a header line with names, then one line per row.
///
/// The separator is a comma, semicolon, tab or any number of blanks, as the header has it; lines of
/// other words before a header are passed over where rows of its cells follow; without a header the
/// columns are called "1", "2", ...; dates with times of day (ISO 8601) are s from the first row's;
/// lines that begin with # are comments, and so are those with % or //; names in the last comment
/// before numbers without a header are the header, words in every cell of the line after it are
/// units; \r\n, quoted cells and a UTF-8 byte order mark are borne; columns not asked for are
/// listed by ignored_columns() and not parsed. A short or long row, a cell that is no number, and a
/// time that does not increase are errors with file, line and column, or counted with
/// skip_bad_lines, and with it also up to 16 rows in a row that are a minute or more ahead. A last
/// line without its end may be incomplete: it is dropped and sets truncated.
class CsvReader final : public RecordedRows {
 public:
  /// Reads up to the header. Errors: no such file, empty, no header, binary data, a candump log, a
  /// required column that is missing (the columns present are named), a name that stands twice.
  static Outcome<std::unique_ptr<CsvReader>> open(const RowFileConfig& config);
  [[nodiscard]] std::optional<double> share_read() const noexcept override {
    return reader_.share_read();
  }
  [[nodiscard]] std::optional<std::int64_t> start_utc_ns() const noexcept override {
    return first_stamp_ns_;
  }

 private:
  CsvReader(const RowFileConfig& config, LineReader reader);
  [[nodiscard]] Step read_one(std::span<double> row) noexcept override;
  [[nodiscard]] Outcome<bool> read_header();
  [[nodiscard]] LineReader::Status next_line(std::string_view& line) noexcept;
  void pass_preamble() noexcept;
  [[nodiscard]] bool read_cell(std::string_view cell, double& number) noexcept;
  [[nodiscard]] static bool is_comment(std::string_view line) noexcept;
  bool take_units(std::string_view line) noexcept;
  Step take_line(std::string_view line, std::span<double> row) noexcept;
  Step end_of_file() noexcept;
  Step bad_line(std::size_t column, std::string found, std::string expected) noexcept;

  LineReader reader_;
  char separator_{','};
  bool has_preamble_{false};
  std::optional<std::int64_t> first_stamp_ns_;
  std::string first_row_;  // that was read in search of the header
};

}  // namespace dampline::drivers

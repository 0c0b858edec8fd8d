// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/text/line_reader.hpp"
#include "hal/row_source.hpp"

namespace dampline::drivers {

struct CsvConfig {
  std::string path{};                   ///< "-": standard input
  std::vector<std::string> required{};  ///< canonical column names, in the order of a row
  std::vector<std::string> optional{};  ///< follow in the row; NaN where the record lacks them
  std::map<std::string, std::string> renamed{};  ///< canonical name -> name in the header
  std::string time_column{
      "time_s"};               ///< must increase from row to row where it is among the columns
  bool skip_bad_lines{false};  ///< count them in health().malformed and go on
};

/// A table in text as a source of rows: a header line with names, then one line per row.
///
/// The separator is a comma, semicolon or tab, as the header has it; lines that begin with # are
/// comments, and so are those with % or //; names in the last comment before numbers without a
/// header are the header, words in every cell of the line after it are units; \r\n, quoted cells
/// and a UTF-8 byte order mark are borne; columns not asked for are listed by ignored_columns() and
/// not parsed. A short or long row, a cell that is no number, and a time that does not increase are
/// errors with file, line and column, or counted with skip_bad_lines, and with it also up to 16
/// rows in a row that are a minute or more ahead. A last line without its end may be incomplete: it
/// is dropped and sets truncated.
class CsvReader final : public hal::RowSource {
 public:
  /// Reads up to the header. Errors: no such file, empty, no header, binary data, a candump log, a
  /// required column that is missing (the columns present are named), a name that stands twice.
  static Outcome<std::unique_ptr<CsvReader>> open(const CsvConfig& config);
  /// The header's names alone, to decide what a record is.
  static Outcome<std::vector<std::string>> header_of(const std::string& path);

  /// Why read() returned kMalformed or kIo.
  [[nodiscard]] const std::string& error_text() const noexcept { return error_; }
  [[nodiscard]] const std::vector<std::string>& header() const noexcept { return header_; }
  /// Of each column of the header, once the first row was read; empty: the file has none.
  [[nodiscard]] const std::vector<std::string>& units() const noexcept { return units_; }
  [[nodiscard]] const std::vector<std::string>& ignored_columns() const noexcept {
    return ignored_;
  }
  /// Whether the record has a column, by its canonical name.
  [[nodiscard]] bool has(std::string_view canonical) const noexcept;

 private:
  explicit CsvReader(const CsvConfig& config, LineReader reader);
  [[nodiscard]] Result<std::size_t> do_read(std::span<double> out) noexcept override;
  [[nodiscard]] std::size_t do_width() const noexcept override { return names_.size(); }
  [[nodiscard]] hal::RowHealth do_health() const noexcept override { return health_; }

  enum class Step : std::uint8_t { kRow, kNoRow, kWait, kStop };
  [[nodiscard]] Outcome<bool> read_header();
  [[nodiscard]] Outcome<bool> choose_columns(const CsvConfig& config);
  [[nodiscard]] std::string column_name(const CsvConfig& config,
                                        const std::string& canonical) const;
  Step read_one(std::span<double> row) noexcept;
  [[nodiscard]] static bool is_comment(std::string_view line) noexcept;
  bool take_units(std::string_view line) noexcept;
  Step take_line(std::string_view line, std::span<double> row) noexcept;
  [[nodiscard]] bool is_near(double time) noexcept;
  Step end_of_file() noexcept;
  Step bad_line(std::size_t column, std::string found, std::string expected) noexcept;
  Step stop(Errc reason, std::string text) noexcept;

  static constexpr std::size_t kUnused = static_cast<std::size_t>(-1);
  LineReader reader_;
  char separator_{','};
  std::vector<std::string> header_;
  std::vector<std::string> units_;
  std::string first_row_;           // that was read in search of the header
  std::vector<std::string> names_;  // of a row's numbers
  std::vector<std::string> ignored_;
  std::vector<std::size_t> place_of_;  // header column -> place in the row, or kUnused
  std::vector<bool> present_;          // by place in the row
  std::string time_column_;
  std::size_t time_place_{kUnused};
  static constexpr double kMostS = 3.2e8;  // a record of ten years; its ns fit into 64 bits
  static constexpr double kFarS = 60.0;
  static constexpr int kFarRows = 16;
  double first_time_{0.0};
  double newest_time_{0.0};
  double far_time_{0.0};  // of the last row that was far ahead
  int far_rows_{0};       // in a row
  bool skip_bad_lines_;
  bool stopped_{false};
  Errc reason_{Errc::kEndOfStream};
  hal::RowHealth health_{};
  std::string error_;
};

}  // namespace dampline::drivers

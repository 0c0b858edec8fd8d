// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/outcome.hpp"
#include "drivers/record/format.hpp"
#include "hal/row_source.hpp"

namespace dampline::drivers {

struct RowFileConfig {
  std::string path{};                   ///< "-": standard input
  std::vector<std::string> required{};  ///< canonical column names, in the order of a row
  std::vector<std::string> optional{};  ///< follow in the row; NaN where the record lacks them
  std::map<std::string, std::string> renamed{};  ///< canonical name -> name in the header
  std::string time_column{
      "time_s"};               ///< must increase from row to row where it is among the columns
  bool skip_bad_lines{false};  ///< count them in health().malformed and go on
};

/// Rows of named columns of a recording, whatever wrote it. In constant memory, whatever its
/// length.
class RecordedRows : public hal::RowSource {
 public:
  /// Why read() returned kMalformed or kIo: file, line and column, what was found and expected.
  [[nodiscard]] const std::string& error_text() const noexcept { return error_; }
  [[nodiscard]] const std::vector<std::string>& header() const noexcept { return header_; }
  /// Of each column of the header, once the first row was read; empty: the file has none.
  [[nodiscard]] const std::vector<std::string>& units() const noexcept { return units_; }
  [[nodiscard]] const std::vector<std::string>& ignored_columns() const noexcept {
    return ignored_;
  }
  /// Whether the record has a column, by its canonical name.
  [[nodiscard]] bool has(std::string_view canonical) const noexcept;
  /// Of the file, 0...1; none of a pipe.
  [[nodiscard]] virtual std::optional<double> share_read() const noexcept = 0;
  /// Since 1970, where its times are dates, once the first row was read.
  [[nodiscard]] virtual std::optional<std::int64_t> start_utc_ns() const noexcept { return {}; }

 protected:
  static constexpr std::size_t kUnused = static_cast<std::size_t>(-1);
  enum class Step : std::uint8_t { kRow, kNoRow, kWait, kStop };

  explicit RecordedRows(const RowFileConfig& config);
  /// Of header_ those that were asked for, by name, else by number from 1 ("3"). Errors: a required
  /// column that is missing (the columns present are named), a name that stands twice. `file` is
  /// what errors call it.
  [[nodiscard]] Outcome<bool> choose_columns(const RowFileConfig& config, const std::string& file);
  /// One step further in the record.
  [[nodiscard]] virtual Step read_one(std::span<double> row) noexcept = 0;
  /// Counts a row that is wrong, and stops there unless such are skipped; `text` as error_text().
  Step bad_row(std::string text) noexcept;
  /// Ends the reading.
  Step stop(Errc reason, std::string text) noexcept;
  /// What is wrong with a row's time; "": nothing, and the row counts as delivered.
  [[nodiscard]] std::string check_time(std::span<const double> row);

  std::vector<std::string> header_;
  std::vector<std::string> units_;
  std::vector<std::string> names_;     // of a row's numbers
  std::vector<std::size_t> place_of_;  // header column -> place in the row, or kUnused
  hal::RowHealth health_{};

 private:
  [[nodiscard]] Result<std::size_t> do_read(std::span<double> out) noexcept final;
  [[nodiscard]] std::size_t do_width() const noexcept final { return names_.size(); }
  [[nodiscard]] hal::RowHealth do_health() const noexcept final { return health_; }
  [[nodiscard]] bool is_near(double time) noexcept;

  bool skip_bad_lines_;
  bool stopped_{false};
  Errc reason_{Errc::kEndOfStream};
  std::string error_;
  std::vector<std::string> ignored_;
  std::vector<bool> present_;  // by place in the row
  std::string time_column_;
  std::size_t time_place_{kUnused};
  static constexpr double kMostS = 3.2e8;  // a record of ten years; its ns fit into 64 bits
  static constexpr double kFarS = 60.0;
  static constexpr int kFarRows = 16;
  double first_time_{0.0};
  double newest_time_{0.0};
  double far_time_{0.0};  // of the last row that was far ahead
  int far_rows_{0};       // in a row
};

/// Opens a recording by its content. Text that is none of the formats is read as a table, which
/// says what is wrong with it; frames and formats that are not read are refused by name.
[[nodiscard]] Outcome<std::unique_ptr<RecordedRows>> open_rows(const RowFileConfig& config);

/// The header's names alone, to decide what a record is.
[[nodiscard]] Outcome<std::vector<std::string>> header_of(const std::string& path);

}  // namespace dampline::drivers

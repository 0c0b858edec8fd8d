// SPDX-License-Identifier: MIT
#include "drivers/csv/csv_reader.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "drivers/csv/csv_line.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::drivers {

Outcome<std::unique_ptr<CsvReader>> CsvReader::open(const CsvConfig& config) {
  Outcome<LineReader> lines = LineReader::open(config.path);
  if (!lines.ok()) return lines.failure();
  std::unique_ptr<CsvReader> reader{new CsvReader{config, std::move(lines.value())}};
  if (Outcome<bool> header = reader->read_header(); !header.ok()) return header.failure();
  if (Outcome<bool> columns = reader->choose_columns(config); !columns.ok())
    return columns.failure();
  return reader;
}

Outcome<std::vector<std::string>> CsvReader::header_of(const std::string& path) {
  CsvConfig config;
  config.path = path;
  Outcome<std::unique_ptr<CsvReader>> reader = open(config);
  if (!reader.ok()) return reader.failure();
  return reader.value()->header();
}

CsvReader::CsvReader(const CsvConfig& config, LineReader reader)
    : reader_{std::move(reader)},
      time_column_{config.time_column},
      skip_bad_lines_{config.skip_bad_lines} {}

bool CsvReader::has(std::string_view canonical) const noexcept {
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (names_[i] == canonical) return present_[i];
  }
  return false;
}

Result<std::size_t> CsvReader::do_read(std::span<double> out) noexcept {
  const std::size_t width = names_.size();
  if (width == 0) return Errc::kInvalidConfig;
  std::size_t rows = 0;
  while ((rows + 1) * width <= out.size() && !stopped_) {
    const Step step = read_one(out.subspan(rows * width, width));
    if (step == Step::kRow) ++rows;
    if (step == Step::kWait) break;
  }
  if (rows == 0 && stopped_) return reason_;
  return rows;
}

CsvReader::Step CsvReader::read_one(std::span<double> row) noexcept {
  if (!first_row_.empty()) return take_line(std::exchange(first_row_, {}), row);
  std::string_view line;
  switch (reader_.next(line)) {
    case LineReader::Status::kLine:
      return take_line(line, row);
    case LineReader::Status::kTooLong:
      return bad_line(1, quote(line), "a row");
    case LineReader::Status::kTail:
      health_.truncated = true;
      return Step::kNoRow;
    case LineReader::Status::kNothingYet:
      return Step::kWait;
    case LineReader::Status::kEnd:
      return end_of_file();
    case LineReader::Status::kError:
      break;
  }
  return stop(Errc::kIo, fmt::format("{}: cannot be read: {}", reader_.name(),
                                     std::strerror(reader_.error_number())));
}

/// Words in every cell of the first line after the header.
bool CsvReader::take_units(std::string_view line) noexcept {
  if (health_.rows > 0 || !units_.empty()) return false;
  std::string_view rest = line;
  std::size_t cells = 0;
  bool any = false;
  double number = 0.0;
  for (bool more = true; more; ++cells) {
    const std::string_view cell = take_cell(rest, separator_, more);
    if (!cell.empty() && read_number(cell, separator_, number)) return false;
    any = any || !cell.empty();
  }
  if (!any || cells != header_.size()) return false;
  units_ = cells_of(line, separator_);
  return true;
}

CsvReader::Step CsvReader::take_line(std::string_view line, std::span<double> row) noexcept {
  if (line.empty() || is_comment(line) || take_units(line)) {
    ++health_.ignored;
    return Step::kNoRow;
  }
  std::fill(row.begin(), row.end(), std::numeric_limits<double>::quiet_NaN());
  std::string_view rest = line;
  bool more = true;
  std::size_t column = 0;
  for (; more && column < place_of_.size(); ++column) {
    const std::size_t at = line.size() - rest.size();
    const std::string_view cell = take_cell(rest, separator_, more);
    const std::size_t place = place_of_[column];
    if (place == kUnused || read_number(cell, separator_, row[place])) continue;
    return bad_line(at + 1, quote(cell), fmt::format("a number for {}", header_[column]));
  }
  if (column < place_of_.size() || (more && !rest.empty())) {
    const auto cells = cells_of(line, separator_).size();
    return bad_line(line.size() + 1, fmt::format("{} cells", cells),
                    fmt::format("{}", place_of_.size()));
  }
  if (time_place_ != kUnused) {
    const double time = row[time_place_];
    const bool first = health_.rows == 0;
    if (!(first ? time == time : time > newest_time_)) {
      const std::string expected = first ? "a time" : fmt::format("a time after {}", newest_time_);
      return bad_line(1, fmt::format("{} = {}", time_column_, time), expected);
    }
    newest_time_ = time;
  }
  ++health_.rows;
  health_.line = reader_.line_number();
  return Step::kRow;
}

CsvReader::Step CsvReader::bad_line(std::size_t column, std::string found,
                                    std::string expected) noexcept {
  ++health_.malformed;
  if (skip_bad_lines_) return Step::kNoRow;
  return stop(Errc::kMalformed, fmt::format("{}:{}:{}: found {}, expected {}", reader_.name(),
                                            reader_.line_number(), column, found, expected));
}

CsvReader::Step CsvReader::end_of_file() noexcept {
  if (health_.rows > 0) return stop(Errc::kEndOfStream, {});
  return stop(Errc::kMalformed, fmt::format("{}: found a header but no row", reader_.name()));
}

CsvReader::Step CsvReader::stop(Errc reason, std::string text) noexcept {
  stopped_ = true;
  reason_ = reason;
  error_ = std::move(text);
  return Step::kStop;
}

}  // namespace dampline::drivers

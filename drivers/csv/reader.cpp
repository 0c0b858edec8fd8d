// SPDX-License-Identifier: MIT
#include "drivers/csv/reader.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "drivers/csv/line.hpp"
#include "drivers/text/cursor.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::drivers {
namespace {

constexpr std::string_view kExampleHeader =
    "a header line with column names, such as \"time_s,deflection_m,force_n\"";

bool is_number(std::string_view cell) {
  double number = 0.0;
  return !cell.empty() && read_number(cell, ',', number) && std::isfinite(number);
}

/// What a line is instead of a header; nothing when it may be one.
std::string_view why_no_header(std::string_view line, const std::vector<std::string>& cells) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; };
  if (std::any_of(line.begin(), line.end(), is_control)) return "binary data";
  if (line.front() == '(' && line.find('#') != std::string_view::npos) return "a candump log";
  if (cells.size() == 1 && is_number(cells[0])) return "a number without a header";
  return {};
}

/// How comments begin: as Python, MATLAB and C write them. 0: it is none.
std::size_t comment_mark(std::string_view line) noexcept {
  if (line.starts_with('#') || line.starts_with('%')) return 1;
  return line.starts_with("//") ? 2 : 0;
}

/// A row: numbers, dates and empty cells, and a number or a date in front. Returns its cells, else
/// 0.
std::size_t cells_of_row(std::string_view line, char separator) {
  std::size_t cells = 0;
  double number = 0.0;
  for (bool more = true; more; ++cells) {
    const std::string_view cell = take_cell(line, separator, more);
    const bool fits = read_number(cell, separator, number) || read_stamp(cell).has_value();
    if (!fits || (cells == 0 && cell.empty())) return 0;
  }
  return cells;
}

/// Cells of a line of names: none of them is a number, the first is not empty; else 0.
std::size_t cells_of_names(std::string_view line, char separator) {
  std::size_t cells = 0;
  for (bool more = true; more; ++cells) {
    const std::string_view cell = take_cell(line, separator, more);
    if (is_number(cell) || (cells == 0 && cell.empty())) return 0;
  }
  return cells;
}

/// Units below names: short, or in brackets.
bool may_be_units(std::string_view line, char separator) {
  constexpr std::size_t kLongestUnit = 6;
  for (bool more = true; more;) {
    const std::string_view cell = take_cell(line, separator, more);
    const bool bracketed = cell.starts_with('[') || cell.starts_with('(');
    if (cell.size() > kLongestUnit && !bracketed) return false;
  }
  return true;
}

struct Layout {
  std::size_t before{0};  ///< lines before the header
  char separator{','};
};

/// Where two rows follow each other for the first time, and the line before has as many names.
std::optional<Layout> find_header(const std::vector<std::string_view>& lines) {
  for (const char separator : {'\t', ';', ',', ' '})
    for (std::size_t i = 1; i + 1 < lines.size(); ++i) {
      const std::size_t cells = cells_of_row(lines[i], separator);
      if (cells < 2 || cells_of_row(lines[i + 1], separator) != cells) continue;
      if (cells_of_names(lines[i - 1], separator) != cells) break;
      const bool units = i >= 2 && may_be_units(lines[i - 1], separator) &&
                         cells_of_names(lines[i - 2], separator) == cells;
      return Layout{i - (units ? 2 : 1), separator};
    }
  return std::nullopt;
}

}  // namespace

bool CsvReader::is_comment(std::string_view line) noexcept { return comment_mark(line) > 0; }

// What programs of measuring devices write before the header: words without a comment's mark.
void CsvReader::pass_preamble() noexcept {
  std::vector<std::string_view> lines;
  std::string_view head = reader_.peek();
  while (head.find('\n') != std::string_view::npos) {
    std::string_view line = head.substr(0, head.find('\n'));
    head.remove_prefix(line.size() + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
  }
  const auto first = std::find_if(lines.begin(), lines.end(), [](std::string_view line) {
    return !line.empty() && !is_comment(line);
  });
  const std::optional<Layout> layout = find_header(lines);
  if (!layout || layout->before <= static_cast<std::size_t>(first - lines.begin())) return;
  has_preamble_ = true;
  separator_ = layout->separator;
  std::string_view line;
  for (std::size_t i = 0; i < layout->before; ++i) static_cast<void>(reader_.next(line));
  health_.ignored += layout->before;
}

/// Waits for it.
LineReader::Status CsvReader::next_line(std::string_view& line) noexcept {
  LineReader::Status status{};
  while ((status = reader_.next(line)) == LineReader::Status::kNothingYet)
    static_cast<void>(reader_.wait(std::chrono::seconds{1}));
  return status;
}

Outcome<bool> CsvReader::read_header() {
  pass_preamble();
  std::string_view line;
  LineReader::Status status{};
  const auto malformed = [&](std::string_view found) {
    return Failure{Errc::kMalformed,
                   fmt::format("{}: found {}, expected {}", reader_.name(), found, kExampleHeader)};
  };
  std::string comment;
  do {
    if (!line.empty()) comment = line.substr(comment_mark(line));
    status = next_line(line);
    if (reader_.line_number() == 1) line = without_byte_order_mark(line);
  } while (status == LineReader::Status::kLine && (line.empty() || is_comment(line)));
  if (status == LineReader::Status::kError) {
    return Failure{reader_.error(), reader_.error_text()};
  }
  if (status == LineReader::Status::kEnd || line.empty()) return malformed("nothing: it is empty");
  if (!has_preamble_) separator_ = separator_of(line);
  header_ = cells_of(line, separator_);
  if (header_.size() > 1 && std::all_of(header_.begin(), header_.end(), is_number)) {
    // The names in the last comment, as NumPy writes them.
    std::vector<std::string> names = cells_of(comment, separator_);
    if (names.size() == header_.size() && std::none_of(names.begin(), names.end(), is_number)) {
      header_ = std::move(names);
    } else {
      for (std::size_t i = 0; i < header_.size(); ++i) header_[i] = std::to_string(i + 1);
    }
    first_row_ = line;
    return true;
  }
  if (const std::string_view kind = why_no_header(line, header_); !kind.empty()) {
    return malformed(fmt::format("{} beginning {}", kind, quote(line)));
  }
  return true;
}

Outcome<std::unique_ptr<CsvReader>> CsvReader::open(const RowFileConfig& config) {
  Outcome<LineReader> lines = LineReader::open(config.path);
  if (!lines.ok()) return lines.failure();
  std::unique_ptr<CsvReader> reader{new CsvReader{config, std::move(lines.value())}};
  if (Outcome<bool> header = reader->read_header(); !header.ok()) return header.failure();
  if (Outcome<bool> columns = reader->choose_columns(config, reader->reader_.name()); !columns.ok())
    return columns.failure();
  return reader;
}

CsvReader::CsvReader(const RowFileConfig& config, LineReader reader)
    : RecordedRows{config}, reader_{std::move(reader)} {}

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
  return stop(reader_.error(), reader_.error_text());
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
    if (!cell.empty() && (read_number(cell, separator_, number) || read_stamp(cell))) return false;
    any = any || !cell.empty();
  }
  if (!any || cells != header_.size()) return false;
  units_ = cells_of(line, separator_);
  return true;
}

/// A number, or a date with a time of day: s from the first one.
bool CsvReader::read_cell(std::string_view cell, double& number) noexcept {
  if (read_number(cell, separator_, number)) return true;
  const std::optional<Stamp> stamp = read_stamp(cell);
  if (!stamp) return false;
  if (!first_stamp_ns_) first_stamp_ns_ = stamp->utc_ns;
  number = static_cast<double>(stamp->utc_ns - *first_stamp_ns_) / 1e9;
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
    if (place == kUnused || read_cell(cell, row[place])) continue;
    return bad_line(at + 1, quote(cell), fmt::format("a number for {}", header_[column]));
  }
  if (column < place_of_.size() || (more && !rest.empty())) {
    const auto cells = cells_of(line, separator_).size();
    return bad_line(line.size() + 1, fmt::format("{} cells", cells),
                    fmt::format("{}", place_of_.size()));
  }
  if (const std::string fault = check_time(row); !fault.empty())
    return bad_row(fmt::format("{}:{}:1: {}", reader_.name(), reader_.line_number(), fault));
  health_.line = reader_.line_number();
  return Step::kRow;
}

CsvReader::Step CsvReader::bad_line(std::size_t column, std::string found,
                                    std::string expected) noexcept {
  return bad_row(fmt::format("{}:{}:{}: found {}, expected {}", reader_.name(),
                             reader_.line_number(), column, found, expected));
}

CsvReader::Step CsvReader::end_of_file() noexcept {
  health_.truncated = health_.truncated || reader_.is_cut_off();
  if (health_.rows > 0) return stop(Errc::kEndOfStream, {});
  return stop(Errc::kMalformed, fmt::format("{}: found a header but no row", reader_.name()));
}

}  // namespace dampline::drivers

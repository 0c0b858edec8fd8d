// SPDX-License-Identifier: MIT
#include "drivers/csv/reader.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "drivers/csv/line.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::drivers {
namespace {

constexpr std::string_view kExample =
    "a header line with column names, such as \"time_s,deflection_m,force_n\"";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool is_number(std::string_view cell) {
  double number = 0.0;
  return !cell.empty() && read_number(cell, ',', number) && std::isfinite(number);
}

/// What a line is instead of a header; nothing when it may be one.
std::string_view why_no_header(std::string_view line, const std::vector<std::string>& cells) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; };
  if (std::any_of(line.begin(), line.end(), is_control)) return "binary data";
  if (line.front() == '(' && line.find('#') != std::string_view::npos) return "a candump log";
  if (std::all_of(cells.begin(), cells.end(), is_number)) return "numbers without a header";
  return {};
}

/// How comments begin: as Python, MATLAB and C write them. 0: it is none.
std::size_t comment_mark(std::string_view line) noexcept {
  if (line.starts_with('#') || line.starts_with('%')) return 1;
  return line.starts_with("//") ? 2 : 0;
}

std::string joined(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

}  // namespace

bool CsvReader::is_comment(std::string_view line) noexcept { return comment_mark(line) > 0; }

Outcome<bool> CsvReader::read_header() {
  std::string_view line;
  LineReader::Status status{};
  const auto malformed = [&](std::string_view found) {
    return Failure{Errc::kMalformed,
                   fmt::format("{}: found {}, expected {}", reader_.name(), found, kExample)};
  };
  std::string comment;
  do {
    if (!line.empty()) comment = line.substr(comment_mark(line));
    while ((status = reader_.next(line)) == LineReader::Status::kNothingYet) {
      static_cast<void>(reader_.wait(std::chrono::seconds{1}));
    }
    if (reader_.line_number() == 1 && line.starts_with(kByteOrderMark))
      line.remove_prefix(kByteOrderMark.size());
  } while (status == LineReader::Status::kLine && (line.empty() || is_comment(line)));
  if (status == LineReader::Status::kError) {
    return Failure{Errc::kIo, fmt::format("{}: cannot be read: {}", reader_.name(),
                                          std::strerror(reader_.error_number()))};
  }
  if (status == LineReader::Status::kEnd || line.empty()) return malformed("nothing: it is empty");
  separator_ = separator_of(line);
  header_ = cells_of(line, separator_);
  if (header_.size() > 1 && std::all_of(header_.begin(), header_.end(), is_number)) {
    // The names in the last comment, as NumPy writes them.
    std::vector<std::string> names = cells_of(comment, separator_);
    if (names.size() == header_.size() && std::none_of(names.begin(), names.end(), is_number)) {
      header_ = std::move(names);
      first_row_ = line;
      return true;
    }
  }
  if (const std::string_view kind = why_no_header(line, header_); !kind.empty()) {
    return malformed(fmt::format("{} beginning {}", kind, quote(line)));
  }
  return true;
}

std::string CsvReader::column_name(const CsvConfig& config, const std::string& canonical) const {
  const auto renamed = config.renamed.find(canonical);
  return renamed == config.renamed.end() ? canonical : renamed->second;
}

Outcome<bool> CsvReader::choose_columns(const CsvConfig& config) {
  names_ = config.required;
  names_.insert(names_.end(), config.optional.begin(), config.optional.end());
  place_of_.assign(header_.size(), kUnused);
  present_.assign(names_.size(), false);
  for (std::size_t place = 0; place < names_.size(); ++place) {
    const std::string name = column_name(config, names_[place]);
    if (names_[place] == config.time_column) time_place_ = place;
    const auto times = std::count(header_.begin(), header_.end(), name);
    if (times > 1) {
      return Failure{Errc::kMalformed, fmt::format("{}: column {} stands twice in the header",
                                                   reader_.name(), quote(name))};
    }
    if (times == 1) {
      const auto column = std::find(header_.begin(), header_.end(), name) - header_.begin();
      std::size_t& taken = place_of_[static_cast<std::size_t>(column)];
      if (taken != kUnused) {
        return Failure{Errc::kInvalidConfig,
                       fmt::format("{}: column {} is asked for as {} and as {}", reader_.name(),
                                   quote(name), names_[taken], names_[place])};
      }
      taken = place;
      present_[place] = true;
    } else if (place < config.required.size() || config.renamed.count(names_[place]) > 0) {
      return Failure{
          Errc::kMalformed,
          fmt::format("{}: found no column {}{}, expected it among: {}", reader_.name(),
                      quote(name), name == names_[place] ? "" : " (for " + names_[place] + ")",
                      joined(header_))};
    }
  }
  if (time_place_ != kUnused && !present_[time_place_]) time_place_ = kUnused;
  for (std::size_t column = 0; column < header_.size(); ++column) {
    if (place_of_[column] == kUnused) ignored_.push_back(header_[column]);
  }
  return true;
}

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
    if (!(first ? std::isfinite(time) : time > newest_time_ && time - first_time_ < kMostS)) {
      const std::string expected = first ? "a time" : fmt::format("a time after {}", newest_time_);
      return bad_line(1, fmt::format("{} = {}", time_column_, time), expected);
    }
    if (!first && skip_bad_lines_ && !is_near(time))
      return bad_line(1, fmt::format("{} = {}", time_column_, time), "no time that is far ahead");
    if (first) first_time_ = time;
    newest_time_ = time;
  }
  ++health_.rows;
  health_.line = reader_.line_number();
  return Step::kRow;
}

/// Few rows that are far ahead are wrong, or all that follow would be; many are a pause.
bool CsvReader::is_near(double time) noexcept {
  const bool goes_on = time > far_time_ && time - far_time_ < kFarS;
  far_rows_ = time - newest_time_ < kFarS ? 0 : goes_on ? far_rows_ + 1 : 1;
  far_time_ = time;
  const bool near = far_rows_ == 0 || far_rows_ > kFarRows;
  if (near) far_rows_ = 0;
  return near;
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

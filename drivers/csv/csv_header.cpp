// SPDX-License-Identifier: MIT
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "drivers/csv/csv_line.hpp"
#include "drivers/csv/csv_reader.hpp"
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

}  // namespace dampline::drivers

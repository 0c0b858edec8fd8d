// SPDX-License-Identifier: MIT
#include "drivers/record/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/csv/reader.hpp"
#include "drivers/hdf5/reader.hpp"
#include "drivers/mat/reader.hpp"
#include "drivers/mdf/reader.hpp"
#include "drivers/npy/reader.hpp"
#include "drivers/text/cursor.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::drivers {
namespace {

/// What the header calls a column. A number is that of a column, unless one is called so.
std::string name_in_header(const RowFileConfig& config, const std::string& canonical,
                           const std::vector<std::string>& header) {
  const auto renamed = config.renamed.find(canonical);
  if (renamed == config.renamed.end()) return canonical;
  const std::string& name = renamed->second;
  if (std::find(header.begin(), header.end(), name) != header.end()) return name;
  const auto number = read_whole_number(name, 10);
  return number && *number >= 1 && *number <= header.size() ? header[*number - 1] : name;
}

}  // namespace

RecordedRows::RecordedRows(const RowFileConfig& config)
    : skip_bad_lines_{config.skip_bad_lines}, time_column_{config.time_column} {}

bool RecordedRows::has(std::string_view canonical) const noexcept {
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (names_[i] == canonical) return present_[i];
  }
  return false;
}

Outcome<bool> RecordedRows::choose_columns(const RowFileConfig& config, const std::string& file) {
  names_ = config.required;
  names_.insert(names_.end(), config.optional.begin(), config.optional.end());
  place_of_.assign(header_.size(), kUnused);
  present_.assign(names_.size(), false);
  for (std::size_t place = 0; place < names_.size(); ++place) {
    const std::string name = name_in_header(config, names_[place], header_);
    if (names_[place] == config.time_column) time_place_ = place;
    const auto times = std::count(header_.begin(), header_.end(), name);
    if (times > 1) {
      return Failure{Errc::kMalformed,
                     fmt::format("{}: column {} stands twice in the header", file, quote(name))};
    }
    if (times == 1) {
      const auto column = std::find(header_.begin(), header_.end(), name) - header_.begin();
      std::size_t& taken = place_of_[static_cast<std::size_t>(column)];
      if (taken != kUnused) {
        return Failure{Errc::kInvalidConfig,
                       fmt::format("{}: column {} is asked for as {} and as {}", file, quote(name),
                                   names_[taken], names_[place])};
      }
      taken = place;
      present_[place] = true;
    } else if (place < config.required.size() || config.renamed.count(names_[place]) > 0) {
      return Failure{
          Errc::kMalformed,
          fmt::format("{}: found no column {}{}, expected it among: {}", file, quote(name),
                      name == names_[place] ? "" : " (for " + names_[place] + ")",
                      list_names(header_))};
    }
  }
  if (time_place_ != kUnused && !present_[time_place_]) time_place_ = kUnused;
  for (std::size_t column = 0; column < header_.size(); ++column) {
    if (place_of_[column] == kUnused) ignored_.push_back(header_[column]);
  }
  return true;
}

Result<std::size_t> RecordedRows::do_read(std::span<double> out) noexcept {
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

RecordedRows::Step RecordedRows::bad_row(std::string text) noexcept {
  ++health_.malformed;
  return skip_bad_lines_ ? Step::kNoRow : stop(Errc::kMalformed, std::move(text));
}

RecordedRows::Step RecordedRows::stop(Errc reason, std::string text) noexcept {
  stopped_ = true;
  reason_ = reason;
  error_ = std::move(text);
  return Step::kStop;
}

std::string RecordedRows::check_time(std::span<const double> row) {
  const bool first = health_.rows == 0;
  if (time_place_ != kUnused) {
    const double time = row[time_place_];
    const auto wrong = [&](std::string_view expected) {
      return fmt::format("found {} = {}, expected {}", time_column_, time, expected);
    };
    if (!(first ? std::isfinite(time) : time > newest_time_ && time - first_time_ < kMostS))
      return wrong(first ? "a time" : fmt::format("a time after {}", newest_time_));
    if (!first && skip_bad_lines_ && !is_near(time)) return wrong("no time that is far ahead");
    if (first) first_time_ = time;
    newest_time_ = time;
  }
  ++health_.rows;
  return {};
}

/// Few rows that are far ahead are wrong, or all that follow would be; many are a pause.
bool RecordedRows::is_near(double time) noexcept {
  const bool goes_on = time > far_time_ && time - far_time_ < kFarS;
  far_rows_ = time - newest_time_ < kFarS ? 0 : goes_on ? far_rows_ + 1 : 1;
  far_time_ = time;
  const bool near = far_rows_ == 0 || far_rows_ > kFarRows;
  if (near) far_rows_ = 0;
  return near;
}

Outcome<std::unique_ptr<RecordedRows>> open_rows(const RowFileConfig& config) {
  const Outcome<RecordFormat> format = detect_format(config.path);
  if (!format) return format.failure();
  if (const std::string_view way_out = way_out_of(format.value()); !way_out.empty())
    return Failure{Errc::kMalformed, fmt::format("{}: is {}, which is not read: {}", config.path,
                                                 name_of(format.value()), way_out)};
  if (format.value() == RecordFormat::kNpy || format.value() == RecordFormat::kNpz)
    return NpyReader::open(config, format.value());
  if (format.value() == RecordFormat::kHdf5) return open_hdf5(config);
  if (format.value() == RecordFormat::kMat) return open_mat(config);
  if (format.value() == RecordFormat::kMdf4Rows) return MdfReader::open(config);
  auto table = CsvReader::open(config);
  if (!table) return table.failure();
  return std::unique_ptr<RecordedRows>{std::move(table.value())};
}

Outcome<std::vector<std::string>> header_of(const std::string& path) {
  RowFileConfig config;
  config.path = path;
  const auto rows = open_rows(config);
  if (!rows) return rows.failure();
  return rows.value()->header();
}

}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#include "drivers/record/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "app/config/columns.hpp"
#include "app/error.hpp"
#include "app/inspect/parts.hpp"
#include "app/record/columns.hpp"
#include "app/record/source_kind.hpp"
#include "app/text/format.hpp"

namespace dampline::app {
namespace {

constexpr double kEpochS = 1e9;     // 2001; what is less counts from anywhere
constexpr double kEpochEndS = 4e9;  // 2096

/// Intervals and gaps of a column of times, s. A gap is more than 1.5 of the usual intervals.
class TimeAxis {
 public:
  void take(double time_s) {
    if (!std::isfinite(time_s)) return;
    if (!first_s_) first_s_ = last_s_ = time_s;
    if (const double step = time_s - last_s_; step > 0.0) take_step(step);
    last_s_ = time_s;
  }
  void conclude(Inspection& found) {
    if (usual_s_ == 0.0) judge();
    if (!first_s_) return;
    found.span_s = last_s_ - *first_s_;
    if (*first_s_ > kEpochS && *first_s_ < kEpochEndS) {
      found.start_s = *first_s_;
      found.clock = drivers::RecordClock::kUtc;
    }
    if (steps_ > 0) found.rate_hz = static_cast<double>(steps_) / sum_s_;
    found.gaps = gaps_;
    found.longest_gap_s = longest_s_;
  }

  [[nodiscard]] double first_s() const { return first_s_.value_or(0.0); }

 private:
  static constexpr std::size_t kFirst = 512;

  void take_step(double step_s) {
    longest_s_ = std::max(longest_s_, step_s);
    if (usual_s_ > 0.0) return count(step_s);
    first_steps_.push_back(step_s);
    if (first_steps_.size() == kFirst) judge();
  }
  void judge() {
    if (first_steps_.empty()) return;
    std::vector<double> sorted = first_steps_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    usual_s_ = *middle;
    for (const double step : first_steps_) count(step);
  }
  void count(double step_s) {
    if (step_s > 1.5 * usual_s_) {
      ++gaps_;
    } else {
      ++steps_;
      sum_s_ += step_s;
    }
  }

  std::optional<double> first_s_;
  double last_s_{0.0};
  double usual_s_{0.0};
  std::vector<double> first_steps_;
  std::uint64_t steps_{0};
  double sum_s_{0.0};
  std::uint64_t gaps_{0};
  double longest_s_{0.0};
};

/// What the program makes of the header; where it makes nothing of it, why.
struct Understood {
  Config config;
  std::optional<SourceKind> kind;
  std::string problem;
  bool guessed{false};  ///< columns of a table without a header
};

/// "1", "2", ...: the table has no header.
bool is_numbered(const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] != std::to_string(i + 1)) return false;
  return !names.empty();
}

/// A column of a table without a header, by its first rows.
struct NumberedColumn {
  std::string name;
  Values values;
  bool rises{true};
  double last{-std::numeric_limits<double>::infinity()};
};

std::vector<NumberedColumn> beginning_of(const std::string& path,
                                         const std::vector<std::string>& names) {
  constexpr std::size_t kRows = 3000;
  drivers::RowFileConfig file;
  file.path = path;
  file.optional = names;
  file.time_column.clear();
  file.skip_bad_lines = true;
  const auto opened = drivers::open_rows(file);
  if (!opened.ok()) throw RunError{opened.error_text()};
  std::vector<NumberedColumn> out(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) out[i].name = names[i];
  std::vector<double> row(names.size());
  for (std::size_t rows = 0; rows < kRows && opened.value()->read(row); ++rows)
    for (std::size_t i = 0; i < row.size(); ++i) {
      out[i].values.take(row[i]);
      out[i].rises = out[i].rises && row[i] > out[i].last;
      out[i].last = row[i];
    }
  return out;
}

/// What rises from row to row is the time; of three others the one that moves least is the frame,
/// of two the larger one is the force. Nothing: it is neither.
void guess_columns(const std::string& path, InputConfig& input) {
  constexpr double kLongestStepS = 0.1;  // beyond it, times are ms
  const auto header = drivers::header_of(path);
  if (!header.ok() || !is_numbered(header.value())) return;
  std::vector<NumberedColumn> columns = beginning_of(path, header.value());
  std::erase_if(columns, [](const NumberedColumn& c) { return !c.values.moves(); });
  const auto time =
      std::find_if(columns.begin(), columns.end(), [](const NumberedColumn& c) { return c.rises; });
  if (time == columns.end() || (columns.size() != 3 && columns.size() != 4)) return;
  input.columns[index(Column::kTime)] = time->name;
  if (time->values.step() > kLongestStepS) input.scale[index(Column::kTime)] = 1e-3;
  columns.erase(time);
  const auto least = std::min_element(columns.begin(), columns.end(), [](auto& a, auto& b) {
    return a.values.rms() < b.values.rms();
  });
  std::rotate(columns.begin(), least, least + 1);
  const auto set = [&](Column column, std::size_t i) {
    input.columns[index(column)] = columns[i].name;
  };
  if (columns.size() == kChannels)
    for (std::size_t c = 0; c < kChannels; ++c) set(kTruckColumns[c], c);
  else
    for (std::size_t c = 0; c < 2; ++c) set(c == 0 ? Column::kDeflection : Column::kForce, c);
}

Understood understand(const std::string& path) {
  Understood out;
  const SourceOptions source{path, true};
  guess_columns(path, out.config.input);
  out.guessed = !out.config.input.columns[index(Column::kTime)].empty();
  try {
    RecognisedColumns seen = recognise_columns(out.config, source);
    out.config = std::move(seen.config);
    out.kind = detect_source(out.config, source);
  } catch (const RunError& error) {
    out.problem = error.what();
  }
  return out;
}

/// The column of times and its factor to s; none: there is none.
struct TimeColumn {
  std::size_t place{0};
  double factor{1.0};
};

std::optional<TimeColumn> time_column(const Understood& understood,
                                      const std::vector<std::string>& names) {
  const std::string wanted = understood.config.input.header(Column::kTime);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == wanted)
      return TimeColumn{i, understood.config.input.scale[index(Column::kTime)]};
  for (std::size_t i = 0; i < names.size(); ++i)
    if (const HeaderName there = read_header_name(names[i]); there.quantity == Quantity::kTime)
      return TimeColumn{i, there.factor.value_or(1.0)};
  return std::nullopt;
}

/// Names that stand once.
std::vector<std::string> unique_names(const std::string& path) {
  const auto header = drivers::header_of(path);
  if (!header.ok()) throw RunError{header.error_text()};
  std::vector<std::string> out;
  for (const std::string& name : header.value())
    if (!name.empty() && std::count(header.value().begin(), header.value().end(), name) == 1)
      out.push_back(name);
  return out;
}

void read_rows(const InspectOptions& options, const std::vector<std::string>& names,
               const std::optional<TimeColumn>& time, Inspection& found) {
  constexpr std::size_t kRows = 256;
  drivers::RowFileConfig file;
  file.path = options.source;
  file.optional = names;
  file.time_column.clear();
  file.skip_bad_lines = true;
  const auto opened = drivers::open_rows(file);
  if (!opened.ok()) throw RunError{opened.error_text()};
  drivers::RecordedRows& rows = *opened.value();
  std::vector<double> values(kRows * names.size());
  TimeAxis axis;
  for (;;) {
    const auto count = rows.read(values);
    if (!count.ok() && count.error() != Errc::kEndOfStream) throw RunError{rows.error_text()};
    if (!count.ok()) break;
    for (std::size_t i = 0; i < count.value() * names.size(); ++i) {
      found.columns[i % names.size()].values.take(values[i]);
      if (time && i % names.size() == time->place) axis.take(time->factor * values[i]);
    }
  }
  axis.conclude(found);
  if (const auto zero_ns = rows.start_utc_ns(); zero_ns && !found.start_s) {
    found.start_s = 1e-9 * static_cast<double>(*zero_ns) + axis.first_s();
    found.clock = drivers::RecordClock::kUtc;
  }
  found.count = rows.health().rows;
  found.malformed = rows.health().malformed;
  const std::vector<std::string>& header = rows.header();
  for (SignalFinding& column : found.columns) {
    const auto place = std::find(header.begin(), header.end(), column.name) - header.begin();
    const auto at = static_cast<std::size_t>(place);
    if (at < rows.units().size() && !rows.units()[at].empty()) column.unit = rows.units()[at];
  }
}

void describe_column(double rate_hz, SignalFinding& column) {
  column.rate_hz = rate_hz;
  if (column.values.moves()) column.resolution = column.values.step();
  const auto factor = unit_factor(Quantity::kAccel, column.unit);
  column.acceleration = factor.has_value();
  column.in_mps2 = factor.value_or(0.0);
}

/// [input.columns] and [input.scale] as recognised.
std::string column_tables(const InputConfig& input, const std::vector<std::string>& names) {
  std::string columns;
  std::string scales;
  for (std::size_t i = 0; i < kColumns; ++i) {
    const std::string header = input.header(static_cast<Column>(i));
    if (std::find(names.begin(), names.end(), header) == names.end()) continue;
    columns += fmt::format("{} = {}\n", kColumnNames[i], toml_string(header));
    if (input.scale[i] != 1.0) scales += fmt::format("{} = {}\n", kColumnNames[i], input.scale[i]);
  }
  return "[input.columns]\n" + columns + (scales.empty() ? "" : "\n[input.scale]\n" + scales);
}

}  // namespace

void inspect_rows(const InspectOptions& options, Inspection& found) {
  const Understood understood = understand(options.source);
  const std::vector<std::string> names = unique_names(options.source);
  const std::optional<TimeColumn> time = time_column(understood, names);
  for (const std::string& name : names) {
    SignalFinding column;
    column.name = name;
    column.unit = read_header_name(name).unit;
    found.columns.push_back(std::move(column));
  }
  read_rows(options, names, time, found);
  for (SignalFinding& column : found.columns) describe_column(found.rate_hz, column);
  if (!understood.problem.empty()) found.notes.push_back(understood.problem);
  if (!understood.kind) return;
  const InputConfig& input = understood.config.input;
  if (understood.guessed)
    found.notes.emplace_back(
        "The table has no header: its columns go by number, and what they are is guessed from what "
        "they hold. Check columns and units.");
  if (*understood.kind == SourceKind::kTruckRows) {
    for (std::size_t c = 0; c < kChannels; ++c)
      found.truck[c] = Candidate{input.header(kTruckColumns[c]),
                                 !understood.guessed ? "by its name"
                                 : c == 0            ? "by its rms, the least of three: check it"
                                                     : "what is left: check it"};
    found.configuration = std::string{kMassLines} + "\n";
  }
  found.configuration += column_tables(input, names);
}

}  // namespace dampline::app

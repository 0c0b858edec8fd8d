// SPDX-License-Identifier: MIT
#include "app/record/columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

#include "app/config/columns.hpp"
#include "app/error.hpp"
#include "drivers/blackbox/shelf.hpp"
#include "drivers/record/format.hpp"
#include "drivers/record/rows.hpp"
#include "drivers/text/kind.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {

std::unique_ptr<drivers::RecordedRows> open_rows(const InputConfig& input,
                                                 const SourceOptions& source,
                                                 std::span<const Column> required,
                                                 std::span<const Column> optional) {
  drivers::RowFileConfig csv;
  csv.path = source.path;
  csv.skip_bad_lines = source.skip_bad_lines;
  csv.time_column = name(Column::kTime);
  for (const Column column : required) csv.required.emplace_back(name(column));
  for (const Column column : optional) csv.optional.emplace_back(name(column));
  for (std::size_t i = 0; i < kColumns; ++i)
    if (!input.columns[i].empty()) csv.renamed[std::string{kColumnNames[i]}] = input.columns[i];
  auto reader = drivers::open_rows(csv);
  if (!reader.ok()) throw RunError{reader.error_text()};
  return std::move(reader.value());
}

void describe_rows(const drivers::RecordedRows& reader, RunResult& result) {
  const hal::RowHealth health = reader.health();
  result.counts.insert(result.counts.end(), {{"rows_read", health.rows},
                                             {"lines_malformed", health.malformed},
                                             {"lines_ignored", health.ignored}});
  if (!reader.ignored_columns().empty())
    result.notes.push_back(fmt::format("Columns that were not used: {}.",
                                       drivers::list_names(reader.ignored_columns())));
  if (health.truncated)
    result.warnings.emplace_back(
        "The file was cut off in the middle of its last line; what is before that "
        "line was used.");
  if (health.malformed > 0)
    result.warnings.push_back(
        fmt::format("{} malformed lines were skipped, as asked for.", health.malformed));
}

namespace {

struct Wanted {
  Column column;
  Quantity quantity;
  bool required;
};
constexpr std::array kRigWanted{Wanted{Column::kTime, Quantity::kTime, true},
                                Wanted{Column::kDeflection, Quantity::kDeflection, true},
                                Wanted{Column::kForce, Quantity::kForce, true},
                                Wanted{Column::kVelocity, Quantity::kVelocity, false},
                                Wanted{Column::kAccel, Quantity::kAccel, false}};
constexpr std::array kTruckWanted{Wanted{Column::kTime, Quantity::kTime, true},
                                  Wanted{Column::kFrameAccel, Quantity::kAccel, true},
                                  Wanted{Column::kWheelset1Accel, Quantity::kAccel, true},
                                  Wanted{Column::kWheelset2Accel, Quantity::kAccel, true},
                                  Wanted{Column::kFrameEndAccel, Quantity::kAccel, false},
                                  Wanted{Column::kFarFrameAccel, Quantity::kAccel, false}};
constexpr std::array kAccelColumns{Column::kFrameAccel, Column::kWheelset1Accel,
                                   Column::kWheelset2Accel};
constexpr std::size_t kFewestRows = 5;
constexpr double kLongestS = 0.1;  // between rows, where the unit of time is a guess

const char* example_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::kTime:
      return "0.001 # if it is in ms; 1.0 if in s";
    case Quantity::kForce:
      return "1000.0 # if it is in kN; 1.0 if in N";
    case Quantity::kAccel:
      return "9.80665 # if it is in g; 1.0 if in m/s^2";
    case Quantity::kVelocity:
      return "0.001 # if it is in mm/s; 1.0 if in m/s";
    case Quantity::kDeflection:
    default:
      return "0.001 # if it is in mm; 1.0 if in m";
  }
}

/// Header and the line of units below it.
struct Head {
  std::vector<std::string> names;
  std::vector<std::string> units;
};

std::optional<Head> head_of(const std::string& path) {
  auto names = drivers::header_of(path);
  if (!names || names.value().empty()) return std::nullopt;
  Head out{std::move(names.value()), {}};
  drivers::RowFileConfig config;
  config.path = path;
  config.skip_bad_lines = true;
  config.time_column.clear();
  for (const std::string& name : out.names)
    if (std::count(out.names.begin(), out.names.end(), name) == 1) config.optional = {name};
  auto reader = drivers::open_rows(config);
  std::array<double, 1> row{};
  if (reader && reader.value()->read(row)) out.units = reader.value()->units();
  return out;
}

/// The median of the first steps of a column.
double step_of(const std::string& path, const std::string& name) {
  drivers::RowFileConfig config;
  config.path = path;
  config.skip_bad_lines = true;
  config.time_column.clear();
  config.optional = {name};
  auto reader = drivers::open_rows(config);
  std::vector<double> steps;
  std::array<double, 1> row{};
  double last = std::numeric_limits<double>::quiet_NaN();
  while (reader && steps.size() < 100 && reader.value()->read(row)) {
    if (row[0] > last) steps.push_back(row[0] - last);
    last = row[0];
  }
  if (steps.size() < kFewestRows) return 0.0;
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                   steps.end());
  return steps[steps.size() / 2];
}

class Recogniser {
 public:
  Recogniser(const Config& given, std::string path, Head head)
      : out_{given, {}}, path_{std::move(path)}, head_{std::move(head)} {}

  RecognisedColumns run() {
    truck_ = is_truck();
    if (truck_) {
      for (const Wanted& wanted : kTruckWanted) look_for(wanted);
      if (!problems_.empty()) fail();
      return out_;
    }
    for (const Wanted& wanted : kRigWanted) look_for(wanted);
    const bool rig = is_found(Column::kForce) || is_found(Column::kDeflection) || !lines_.empty();
    const bool timed = is_found(Column::kTime) || out_.config.input.sample_rate_is_set;
    const bool whole =
        timed && is_found(Column::kForce) && is_found(Column::kDeflection) && problems_.empty();
    if (rig && !whole) fail();
    return out_;
  }

 private:
  [[nodiscard]] bool is_there(const std::string& name) const {
    return std::find(head_.names.begin(), head_.names.end(), name) != head_.names.end();
  }
  [[nodiscard]] bool is_found(Column column) const {
    return is_there(out_.config.input.header(column));
  }
  /// All three accelerations are there, by their names, the configuration's or the header's words.
  [[nodiscard]] bool is_truck() const {
    return std::all_of(kAccelColumns.begin(), kAccelColumns.end(), [&](Column column) {
      return is_found(column) ||
             (is_free(column) && !fitting({column, Quantity::kAccel, true}).empty());
    });
  }
  /// The configuration names none for it.
  [[nodiscard]] bool is_free(Column column) const {
    return out_.config.input.columns[index(column)].empty();
  }
  [[nodiscard]] std::string unit_below(std::size_t at) const {
    return at < head_.units.size() ? head_.units[at] : std::string{};
  }
  [[nodiscard]] double& scale_of(Column column) { return out_.config.input.scale[index(column)]; }

  /// A column's name and unit; the line of units goes before what the header says.
  [[nodiscard]] HeaderName read_name(std::size_t at, Quantity quantity) const {
    HeaderName out = read_header_name(head_.names[at]);
    if (const std::string below = unit_below(at); !below.empty()) out.unit = below;
    out.factor = out.unit.empty() ? std::nullopt : unit_factor(quantity, out.unit);
    return out;
  }

  /// Where the header's words speak of it. Of several, those go whose unit is of another kind.
  [[nodiscard]] std::vector<std::size_t> fitting(const Wanted& wanted) const {
    const bool accel_of_truck =
        std::find(kAccelColumns.begin(), kAccelColumns.end(), wanted.column) != kAccelColumns.end();
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < head_.names.size(); ++i) {
      const bool fits = accel_of_truck
                            ? truck_column(head_.names[i], unit_below(i)) == wanted.column
                            : read_header_name(head_.names[i]).quantity == wanted.quantity;
      if (fits) out.push_back(i);
    }
    std::vector<std::size_t> with_unit = out;
    std::erase_if(with_unit, [&](std::size_t i) {
      const HeaderName there = read_name(i, wanted.quantity);
      return !there.unit.empty() && !there.factor;
    });
    return with_unit.empty() ? out : with_unit;
  }

  void look_for(const Wanted& wanted) {
    const std::string header = out_.config.input.header(wanted.column);
    const auto found = std::find(head_.names.begin(), head_.names.end(), header);
    if (found == head_.names.end())
      recognise(wanted);
    else
      check_unit(wanted, static_cast<std::size_t>(found - head_.names.begin()));
  }

  /// A column that is named by the configuration or canonically, and a unit that says otherwise.
  void check_unit(const Wanted& wanted, std::size_t at) {
    const HeaderName there = read_name(at, wanted.quantity);
    double& scale = scale_of(wanted.column);
    if (scale != 1.0 || there.unit.empty() || there.factor == 1.0) return;
    const bool below = !unit_below(at).empty();
    if (!there.factor && (below || is_unit_of_other(wanted.quantity, there.unit)))
      throw RunError{fmt::format(
          "{}: found \"{}\" {} \"{}\", expected a number or a unit of {}; write into the "
          "configuration:\n[input.scale]\n{} = {}",
          path_, there.unit, below ? "below" : "in", head_.names[at], name(wanted.column),
          name(wanted.column), example_of(wanted.quantity))};
    if (!there.factor) return;
    if (is_free(wanted.column))
      throw RunError{
          fmt::format("{}: found {} in {}, expected what its name says; write into the "
                      "configuration:\n[input.scale]\n{} = {:.6g}",
                      path_, name(wanted.column), there.unit, name(wanted.column), *there.factor)};
    scale = *there.factor;
    note(wanted.column, head_.names[at], there.unit);
  }

  void recognise(const Wanted& wanted) {
    if (!is_free(wanted.column)) return;  // is missed later
    if (truck_ && !wanted.required) return;
    const std::vector<std::size_t> found = fitting(wanted);
    if (found.size() == 1)
      take(wanted, found.front());
    else if (found.size() > 1 && wanted.required)
      propose_one_of(wanted, found);
    else if (wanted.column == Column::kTime && (truck_ || !out_.config.input.sample_rate_is_set))
      problems_.emplace_back(truck_ ? "found no column for time_s"
                                    : "found no column for time_s, and no [input] sample_rate_hz "
                                      "instead");
    else if (wanted.required && wanted.column != Column::kTime)
      problems_.push_back(fmt::format("found no column for {}", name(wanted.column)));
  }

  void take(const Wanted& wanted, std::size_t at) {
    const std::string& header = head_.names[at];
    HeaderName there = read_name(at, wanted.quantity);
    if (wanted.column == Column::kTime && there.unit.empty()) {
      const double step = step_of(path_, header);
      if (step > 0.0 && step <= kLongestS) {
        there.factor = 1.0;
        there.unit = "s, as its steps suggest";
      }
    }
    if (!there.factor) {
      if (!wanted.required) return;
      problems_.emplace_back(there.unit.empty() ? fmt::format(R"("{}" has no unit)", header)
                                                : fmt::format(R"("{}": the unit "{}" is not known)",
                                                              header, there.unit));
      propose(wanted, header);
      return;
    }
    out_.config.input.columns[index(wanted.column)] = header;
    scale_of(wanted.column) *= *there.factor;
    note(wanted.column, header, there.unit);
  }

  void propose(const Wanted& wanted, const std::string& header) {
    lines_.push_back(fmt::format(R"({} = "{}")", name(wanted.column), header));
    scales_.push_back(fmt::format("{} = {}", name(wanted.column), example_of(wanted.quantity)));
  }

  void propose_one_of(const Wanted& wanted, const std::vector<std::size_t>& fitting) {
    std::string list;
    for (const std::size_t i : fitting)
      list += fmt::format(R"({}"{}")", list.empty() ? "" : ", ", head_.names[i]);
    problems_.push_back(fmt::format("{} may be any of {}", name(wanted.column), list));
    propose(wanted, head_.names[fitting.front()]);
  }

  void note(Column column, const std::string& header, const std::string& unit) {
    out_.notes.push_back(fmt::format("{} is column \"{}\" ({}), times {:.6g}.", name(column),
                                     header, unit, scale_of(column)));
  }

  [[noreturn]] void fail() {
    const bool rate = !truck_ && !is_found(Column::kDeflection) &&
                      (is_found(Column::kVelocity) || is_found(Column::kAccel));
    std::string text = fmt::format("{}: {}; columns: {}.", path_, fmt::join(problems_, "; "),
                                   drivers::list_names(head_.names));
    if (rate)
      text +=
          " A rig's record needs its deflection: integrate the velocity, or the acceleration twice "
          "with a high-pass below the motion's lowest frequency, and add it as deflection_m, in m.";
    if (lines_.empty()) {
      lines_.emplace_back(truck_ ? "time_s = \"...\" # its name in the header"
                                 : "deflection_m = \"...\" # and time_s, force_n: names in the "
                                   "header");
      scales_.emplace_back(truck_ ? "time_s = 1.0 # to s" : "deflection_m = 0.001 # to m, s, N");
    }
    if (!rate)
      text +=
          fmt::format(" Write into a file for --config:\n[input.columns]\n{}\n[input.scale]\n{}",
                      fmt::join(lines_, "\n"), fmt::join(scales_, "\n"));
    throw RunError{text};
  }

  RecognisedColumns out_;
  std::string path_;
  Head head_;
  bool truck_{false};
  std::vector<std::string> problems_;
  std::vector<std::string> lines_;   ///< for [input.columns]
  std::vector<std::string> scales_;  ///< for [input.scale]
};

}  // namespace

RecognisedColumns recognise_columns(const Config& given, const SourceOptions& source) {
  const std::filesystem::path path{source.path};
  std::error_code error;
  const bool piped = source.path == "-";
  if (!piped && (!std::filesystem::exists(path, error) || path.extension() == ".log" ||
                 drivers::is_blackbox(source.path)))
    return {given, {}};
  const auto format = drivers::detect_format(source.path);
  if (!format || !holds_rows(format.value())) return {given, {}};
  if (const auto beginning = drivers::read_head(source.path);
      beginning && drivers::foreign_kind(beginning.value()))
    return {given, {}};
  const std::optional<Head> head = head_of(source.path);
  if (!head) return {given, {}};
  return Recogniser{given, source.path, *head}.run();
}

}  // namespace dampline::app

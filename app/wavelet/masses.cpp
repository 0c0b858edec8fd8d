// SPDX-License-Identifier: MIT
#include "app/wavelet/masses.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include "app/config/columns.hpp"
#include "app/error.hpp"
#include "app/record/columns.hpp"
#include "drivers/record/rows.hpp"

namespace dampline::app::wavelet {
namespace {

constexpr std::array<std::string_view, 5> kBaseWords{"base", "ground", "table", "support", "boden"};
constexpr std::array<std::string_view, 5> kResponseWords{"response", "mass", "floor", "top",
                                                         "masse"};

/// A header's cell as it is understood.
struct Cell {
  std::string header;
  HeaderName name;
  int number{0};  ///< 1 or 2 in the name; 0: none
  bool base{false};
  bool response{false};
};

bool has_word(std::string_view text, std::span<const std::string_view> words) {
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
    return text.find(word) != std::string_view::npos;
  });
}

Cell cell_of(const std::string& header) {
  Cell out{.header = header, .name = read_header_name(header)};
  std::string name = header;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (!out.name.unit.empty() && name.size() > out.name.unit.size())
    name.resize(header.rfind(out.name.unit));
  for (const char c : name)
    if (c == '1' || c == '2') out.number = c - '0';
  out.base = has_word(name, kBaseWords);
  out.response = !out.base && has_word(name, kResponseWords);
  return out;
}

std::vector<Cell> cells_of(const std::string& path) {
  auto names = drivers::header_of(path);
  if (!names) throw RunError{names.error_text()};
  std::vector<Cell> out;
  for (const std::string& name : names.value()) out.push_back(cell_of(name));
  return out;
}

struct Sought {
  Role role;
  Quantity quantity;
  int mass;
  std::string canonical;
  bool numbered;  ///< of two masses: the number must be there
};

bool fits(const Cell& cell, const Sought& sought) {
  if (cell.name.quantity != sought.quantity) return false;
  if (sought.numbered && cell.number != sought.mass + 1) return false;
  if (sought.role == Role::kBaseAccel) return cell.base;
  if (sought.role == Role::kResponseAccel) return !cell.base && (cell.response || sought.numbered);
  return !cell.base;
}

MassColumn taken(const std::string& path, const Sought& sought, const Cell& cell) {
  std::optional<double> factor = cell.name.factor;
  if (!factor && sought.role == Role::kTime && cell.name.unit.empty()) factor = 1.0;
  if (!factor)
    throw RunError{
        fmt::format("{}: \"{}\" has no unit that is known, expected {} or a unit in the "
                    "header, as in \"x1 [mm]\"",
                    path, cell.header, sought.canonical)};
  return {sought.role, sought.mass, cell.header, *factor};
}

/// The column, where exactly one is canonical or fits.
std::optional<MassColumn> find(const std::string& path, const std::vector<Cell>& cells,
                               const Sought& sought) {
  std::vector<const Cell*> fitting;
  for (const Cell& cell : cells) {
    if (cell.header == sought.canonical) return MassColumn{sought.role, sought.mass, cell.header};
    if (fits(cell, sought)) fitting.push_back(&cell);
  }
  if (fitting.empty()) return std::nullopt;
  if (fitting.size() > 1)
    throw RunError{fmt::format(R"({}: {} may be "{}" or "{}": rename one of them)", path,
                               sought.canonical, fitting[0]->header, fitting[1]->header)};
  return taken(path, sought, *fitting.front());
}

std::string numbered(std::string_view name, int masses, int mass, std::string_view unit) {
  return fmt::format("{}{}_{}", name, masses == 1 ? "" : std::to_string(mass + 1), unit);
}

/// Takes what is there of `sought`; the names of what is missing.
std::vector<std::string> take(const std::string& path, const std::vector<Cell>& cells,
                              const std::vector<Sought>& all, std::vector<MassColumn>& out) {
  std::vector<std::string> missing;
  for (const Sought& sought : all) {
    if (auto column = find(path, cells, sought))
      out.push_back(std::move(*column));
    else
      missing.push_back(sought.canonical);
  }
  return missing;
}

const Sought kTimeSought{Role::kTime, Quantity::kTime, 0, "time_s", false};

std::vector<Sought> accelerations_of(int masses) {
  std::vector<Sought> out{kTimeSought,
                          {Role::kBaseAccel, Quantity::kAccel, 0, "base_accel_mps2", false}};
  for (int m = 0; m < masses; ++m)
    out.push_back({Role::kResponseAccel, Quantity::kAccel, m,
                   numbered("response", masses, m, "accel_mps2"), masses > 1});
  return out;
}

std::vector<Sought> motion_of(int masses) {
  std::vector<Sought> out{kTimeSought};
  for (int m = 0; m < masses; ++m)
    out.push_back({Role::kDeflection, Quantity::kDeflection, m,
                   numbered("deflection", masses, m, "m"), masses > 1});
  return out;
}

std::vector<Sought> forces_of(int masses) {
  std::vector<Sought> out;
  out.reserve(static_cast<std::size_t>(masses));
  for (int m = 0; m < masses; ++m)
    out.push_back(
        {Role::kForce, Quantity::kForce, m, numbered("force", masses, m, "n"), masses > 1});
  return out;
}

/// A row's numbers by the columns that they stand in.
MassLine line_of(const std::vector<MassColumn>& columns, std::span<const double> row,
                 std::uint64_t line) {
  MassLine out{.line = line};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const double value = columns[i].factor * row[i];
    const auto mass = static_cast<std::size_t>(columns[i].mass);
    switch (columns[i].role) {
      case Role::kTime:
        out.time_s = value;
        break;
      case Role::kBaseAccel:
        out.second = {value, value};
        break;
      case Role::kForce:
        out.second[mass] = value;
        break;
      case Role::kDeflection:
      case Role::kResponseAccel:
        out.first[mass] = value;
        break;
    }
  }
  return out;
}

}  // namespace

bool has_base_and_response(const std::string& path) {
  const std::vector<Cell> cells = cells_of(path);
  const auto any = [&](bool Cell::*role) {
    return std::any_of(cells.begin(), cells.end(), [&](const Cell& cell) {
      return cell.*role && cell.name.quantity == Quantity::kAccel;
    });
  };
  return any(&Cell::base) && any(&Cell::response);
}

std::vector<MassColumn> find_mass_columns(const std::string& path, int masses) {
  const std::vector<Cell> cells = cells_of(path);
  std::vector<MassColumn> out;
  const std::vector<std::string> no_accel = take(path, cells, accelerations_of(masses), out);
  if (no_accel.empty()) return out;
  out.clear();
  std::vector<std::string> missing = take(path, cells, motion_of(masses), out);
  const std::vector<std::string> forces = take(path, cells, forces_of(masses), out);
  if (static_cast<int>(forces.size()) == masses)
    missing.push_back(fmt::format("{}", fmt::join(forces, " or ")));
  if (missing.empty()) return out;
  std::vector<std::string> there;
  there.reserve(cells.size());
  for (const Cell& cell : cells) there.push_back(cell.header);
  throw RunError{
      fmt::format("{}: found no column for {}; nor, for accelerations, for {}; columns: {}", path,
                  fmt::join(missing, ", "), fmt::join(no_accel, ", "), fmt::join(there, ", "))};
}

MassLines read_mass_lines(const SourceOptions& source, int masses, RunResult& reading) {
  const std::vector<MassColumn> columns = find_mass_columns(source.path, masses);
  drivers::RowFileConfig config;
  config.path = source.path;
  config.skip_bad_lines = source.skip_bad_lines;
  config.time_column.clear();  // the clock judges times
  MassLines out;
  for (const MassColumn& column : columns) {
    config.required.push_back(column.header);
    if (column.factor != 1.0)
      out.notes.push_back(fmt::format("\"{}\" times {:.6g}.", column.header, column.factor));
    out.accelerations = out.accelerations || column.role == Role::kBaseAccel;
  }
  auto reader = drivers::open_rows(config);
  if (!reader) throw RunError{reader.error_text()};
  drivers::RecordedRows& csv = *reader.value();
  std::vector<double> row(columns.size());
  for (auto rows = csv.read(row);; rows = csv.read(row)) {
    if (!rows && rows.error() == Errc::kEndOfStream) break;
    if (!rows) throw RunError{csv.error_text()};
    if (rows.value() > 0) out.lines.push_back(line_of(columns, row, csv.health().line));
  }
  describe_rows(csv, reading);
  return out;
}

}  // namespace dampline::app::wavelet

// SPDX-License-Identifier: MIT
#include "app/run/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>

#include "app/error.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

/// The cells of one line of a table that this program wrote.
using Cells = std::vector<std::string_view>;

std::string_view next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

Cells split(std::string_view line) {
  Cells cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t comma = std::min(line.find(',', begin), line.size());
    cells.push_back(line.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return cells;
}

double number(std::string_view cell) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc{} || end != cell.data() + cell.size())
    throw RunError{fmt::format("{} is no number", drivers::quote(cell))};
  return value;
}

/// A number that the integer type can hold; what is behind its point goes.
template <class Integer>
Integer integer(std::string_view cell) {
  constexpr Integer kHalf = std::numeric_limits<Integer>::max() / 2 + 1;
  constexpr double kBeyond = 2.0 * static_cast<double>(kHalf);
  const double value = number(cell);
  if (!(value >= static_cast<double>(std::numeric_limits<Integer>::min()) && value < kBeyond))
    throw RunError{fmt::format("{} is out of range", drivers::quote(cell))};
  return static_cast<Integer>(value);
}

/// Calls `row` with the cells of each line after the header; returns the header's cells. Throws
/// RunError naming `origin` and the line, also for what `row` throws.
std::vector<std::string> read_rows(std::string_view text, const std::string& origin,
                                   const std::function<void(const Cells&)>& row) {
  const Cells header = split(next_line(text));
  for (int line = 2; !text.empty(); ++line) {
    const Cells cells = split(next_line(text));
    try {
      if (cells.size() != header.size())
        throw RunError{fmt::format("{} cells, expected {}", cells.size(), header.size())};
      row(cells);
    } catch (const std::out_of_range&) {
      throw RunError{fmt::format("{}:{}: {} cells, expected more", origin, line, cells.size())};
    } catch (const RunError& error) {
      throw RunError{fmt::format("{}:{}: {}", origin, line, error.what())};
    }
  }
  return {header.begin(), header.end()};
}

/// A table whose rows are plain structs: header, one line in the words of fmt, and where a row has
/// each cell.
template <class... Cell>
struct Table {
  std::string_view header;
  std::string_view line;
  std::tuple<Cell...> cells;
};
template <class... Cell>
constexpr Table<Cell...> table(std::string_view header, std::string_view line, Cell... cells) {
  return {header, line, {cells...}};
}

template <class Row>
constexpr int kTable = 0;
template <>
constexpr auto kTable<ResidualRow> =
    table("over,place,samples,before_mean_n,before_rms_n,after_mean_n,after_rms_n\n",
          "{},{:.9g},{},{:.6g},{:.6g},{:.6g},{:.6g}\n", &ResidualRow::over, &ResidualRow::place,
          &ResidualRow::samples, &ResidualRow::before_mean_n, &ResidualRow::before_rms_n,
          &ResidualRow::after_mean_n, &ResidualRow::after_rms_n);
template <>
constexpr auto kTable<LoopRow> =
    table("time_s,deflection_m,velocity_mps,measured_n,base_n,final_n\n",
          "{:.6f},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", &LoopRow::time_s, &LoopRow::deflection_m,
          &LoopRow::velocity_mps, &LoopRow::measured_n, &LoopRow::base_n, &LoopRow::final_n);
template <>
constexpr auto kTable<LawRow> = table("velocity_mps,base_n,final_n\n", "{:.6g},{:.6g},{:.6g}\n",
                                      &LawRow::velocity_mps, &LawRow::base_n, &LawRow::final_n);
template <>
constexpr auto kTable<MotionRow> = table("time_s,deflection_m,velocity_mps\n",
                                         "{:.9g},{:.6g},{:.6g}\n", &MotionRow::time_s,
                                         &MotionRow::deflection_m, &MotionRow::velocity_mps);
template <>
constexpr auto kTable<ForceRow> = table("time_s,velocity_mps,measured_n,fitted_n\n",
                                        "{:.9g},{:.6g},{:.6g},{:.6g}\n", &ForceRow::time_s,
                                        &ForceRow::velocity_mps, &ForceRow::measured_n,
                                        &ForceRow::fitted_n);
template <>
constexpr auto kTable<Excluded> = table("start_s,end_s,reason\n", "{:.9g},{:.9g},{}\n",
                                        &Excluded::start_s, &Excluded::end_s, &Excluded::reason);
template <>
constexpr auto kTable<RunEvent> = table("time_s,event,line,value\n", "{:.6f},{},{},{}\n",
                                        &RunEvent::time_s, &RunEvent::name, &RunEvent::line,
                                        &RunEvent::value);
template <>
constexpr auto kTable<LatenessRow> = table("from_us,to_us,frames\n", "{:.9g},{:.9g},{}\n",
                                           &LatenessRow::from_us, &LatenessRow::to_us,
                                           &LatenessRow::frames);

template <>
constexpr auto kTable<TermSet> = table("change,t,mse_percent,held_out_mse_percent\n",
                                       "{},{:.6g},{:.6g},{:.6g}\n", &TermSet::change, &TermSet::t,
                                       &TermSet::mse_percent, &TermSet::held_out_mse_percent);

template <class T>
void read_cell(std::string_view cell, T& value) {
  if constexpr (std::is_same_v<T, std::string>)
    value = cell;
  else if constexpr (std::is_integral_v<T>)
    value = integer<T>(cell);
  else
    value = static_cast<T>(number(cell));
}

}  // namespace

template <class Row>
std::string to_csv(const std::vector<Row>& rows) {
  std::string out{kTable<Row>.header};
  for (const Row& row : rows)
    std::apply(
        [&](auto... cell) {
          fmt::format_to(std::back_inserter(out), fmt::runtime(kTable<Row>.line), row.*cell...);
        },
        kTable<Row>.cells);
  return out;
}

template <class Row>
std::vector<Row> read_table(std::string_view text, const std::string& origin) {
  std::vector<Row> out;
  read_rows(text, origin, [&](const Cells& cells) {
    Row& row = out.emplace_back();
    std::size_t i = 0;
    std::apply([&](auto... cell) { (read_cell(cells.at(i++), row.*cell), ...); },
               kTable<Row>.cells);
  });
  return out;
}

template std::string to_csv(const std::vector<ResidualRow>&);
template std::string to_csv(const std::vector<LoopRow>&);
template std::string to_csv(const std::vector<LawRow>&);
template std::string to_csv(const std::vector<MotionRow>&);
template std::string to_csv(const std::vector<ForceRow>&);
template std::string to_csv(const std::vector<Excluded>&);
template std::string to_csv(const std::vector<RunEvent>&);
template std::string to_csv(const std::vector<LatenessRow>&);
template std::string to_csv(const std::vector<TermSet>&);
template std::vector<ResidualRow> read_table(std::string_view, const std::string&);
template std::vector<LoopRow> read_table(std::string_view, const std::string&);
template std::vector<LawRow> read_table(std::string_view, const std::string&);
template std::vector<MotionRow> read_table(std::string_view, const std::string&);
template std::vector<ForceRow> read_table(std::string_view, const std::string&);
template std::vector<Excluded> read_table(std::string_view, const std::string&);
template std::vector<RunEvent> read_table(std::string_view, const std::string&);
template std::vector<LatenessRow> read_table(std::string_view, const std::string&);
template std::vector<TermSet> read_table(std::string_view, const std::string&);

std::string to_csv(const std::vector<CurveRow>& curve, const std::vector<MethodSummary>& methods) {
  std::string out = "velocity_mps,force_n,std_n,samples";
  for (const MethodSummary& m : methods) out += fmt::format(",{0}_n,{0}_std_n", m.name);
  out += '\n';
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const CurveRow& r = curve[i];
    out += fmt::format("{:.9g},{:.9g},{:.6g},{}", r.velocity_mps, r.force_n, r.std_n, r.samples);
    for (const MethodSummary& m : methods)
      out += fmt::format(",{:.9g},{:.6g}", m.curve_n.at(i).value, m.curve_n.at(i).std);
    out += '\n';
  }
  return out;
}

void read_curve(std::string_view text, const std::string& origin, RunResult& result) {
  read_rows(text, origin, [&](const Cells& c) {
    result.curve.push_back(
        {number(c.at(0)), number(c.at(1)), number(c.at(2)), integer<std::uint64_t>(c.at(3))});
    const std::size_t expected = 4 + 2 * result.methods.size();
    if (c.size() < expected)
      throw RunError{
          fmt::format("{} columns, expected {}: a force and its deviation for each "
                      "method of parameters.json",
                      c.size(), expected)};
    for (std::size_t i = 0; i < result.methods.size(); ++i)
      result.methods[i].curve_n.push_back({number(c.at(4 + 2 * i)), number(c.at(5 + 2 * i))});
  });
}

std::string to_csv(const std::vector<DensityTable>& densities) {
  std::string out = "quantity,centre,density,samples,outside_share\n";
  for (const DensityTable& table : densities)
    for (const DensityRow& r : table.rows)
      out += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.6g}\n", table.quantity, r.centre, r.density,
                         r.samples, table.outside_share);
  return out;
}

std::vector<DensityTable> read_densities(std::string_view text, const std::string& origin) {
  std::vector<DensityTable> densities;
  read_rows(text, origin, [&](const Cells& c) {
    if (densities.empty() || densities.back().quantity != c.at(0))
      densities.push_back({std::string{c.at(0)}, number(c.at(4)), {}});
    densities.back().rows.push_back({number(c.at(1)), number(c.at(2)), number(c.at(3))});
  });
  return densities;
}

namespace {

/// The units that columns have, as their names end in them.
struct Symbol {
  std::string_view unit;
  std::string_view letters;
};
constexpr std::array kSymbols{Symbol{"kg", "kg"},    Symbol{"Hz", "hz"}, Symbol{"rad", "rad"},
                              Symbol{"N", "n"},      Symbol{"m", "m"},   Symbol{"s", "s"},
                              Symbol{"%", "percent"}};

/// "N s^2/m^2" as "ns2pm2", which columns of the other tables have too: velocity_mps, accel_mps2.
std::string suffix_of(const std::string& unit) {
  if (unit == "%") return "percent";
  std::string out;
  for (const char c : unit.starts_with("1") ? unit.substr(1) : unit) {
    if (c == '/') out += 'p';
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return out;
}

/// Factors with blanks between; none where they are no units.
std::optional<std::string> factors_of(std::string_view letters) {
  std::string out;
  while (!letters.empty()) {
    const auto* const symbol = std::find_if(kSymbols.begin(), kSymbols.end(), [&](const Symbol& s) {
      return letters.starts_with(s.letters);
    });
    if (symbol == kSymbols.end()) return std::nullopt;
    out += fmt::format("{}{}", out.empty() ? "" : " ", symbol->unit);
    letters.remove_prefix(symbol->letters.size());
    const std::size_t digits = std::min(letters.find_first_not_of("0123456789"), letters.size());
    if (digits > 0) out += fmt::format("^{}", letters.substr(0, digits));
    letters.remove_prefix(digits);
  }
  return out;
}

/// The inverse of suffix_of(); a text that it does not make is its own unit.
std::string unit_of_suffix(std::string_view suffix) {
  if (suffix == "percent") return "%";
  const std::size_t per = suffix.find('p');
  const auto above = factors_of(suffix.substr(0, per));
  if (per == std::string_view::npos) return above.value_or(std::string{suffix});
  const auto below = factors_of(suffix.substr(per + 1));
  if (!above || !below) return std::string{suffix};
  return fmt::format("{}/{}", above->empty() ? "1" : *above, *below);
}

/// Name and unit of an estimate by its two columns, "coulomb_n" and "coulomb_std_n".
std::pair<std::string, std::string> named(const std::string& value, const std::string& deviation) {
  constexpr std::string_view kMark = "_std";
  const std::size_t at = deviation.rfind(kMark);
  if (at == std::string::npos) return {value, ""};
  const std::string name = deviation.substr(0, at);
  const std::string rest = deviation.substr(at + kMark.size());
  if (value != name + rest) return {value, ""};
  return {name, rest.empty() ? "" : unit_of_suffix(std::string_view{rest}.substr(1))};
}

}  // namespace

std::string to_csv(const Convergence& convergence) {
  std::string out = "time_s";
  for (std::size_t i = 0; i < convergence.names.size(); ++i) {
    const std::string suffix = suffix_of(convergence.units[i]);
    out += fmt::format(",{0}{2}{1},{0}_std{2}{1}", convergence.names[i], suffix,
                       suffix.empty() ? "" : "_");
  }
  out += '\n';
  for (const Convergence::Row& row : convergence.rows) {
    out += fmt::format("{:.9g}", row.time_s);
    for (const Estimate& e : row.estimates) out += fmt::format(",{:.9g},{:.6g}", e.value, e.std);
    out += '\n';
  }
  return out;
}

Convergence read_convergence(std::string_view text, const std::string& origin) {
  Convergence convergence;
  const auto header = read_rows(text, origin, [&](const Cells& c) {
    Convergence::Row row{number(c.at(0)), {}};
    for (std::size_t i = 1; i + 1 < c.size(); i += 2)
      row.estimates.push_back({number(c[i]), number(c[i + 1])});
    convergence.rows.push_back(std::move(row));
  });
  for (std::size_t i = 1; i + 1 < header.size(); i += 2) {
    auto [name, unit] = named(header[i], header[i + 1]);
    convergence.names.push_back(std::move(name));
    convergence.units.push_back(std::move(unit));
  }
  return convergence;
}

std::string to_csv(const std::vector<CovRow>& rows, const std::vector<Parameter>& parameters) {
  std::string out = "time_s";
  for (const Parameter& p : parameters) out += fmt::format(",{}_cov", p.name);
  out += '\n';
  for (const CovRow& row : rows) {
    out += fmt::format("{:.9g}", row.time_s);
    for (const double cov : row.cov) out += fmt::format(",{:.6g}", cov);
    out += '\n';
  }
  return out;
}

std::vector<CovRow> read_cov(std::string_view text, const std::string& origin) {
  std::vector<CovRow> out;
  read_rows(text, origin, [&](const Cells& c) {
    CovRow row{number(c.at(0)), {}};
    for (std::size_t i = 1; i < c.size(); ++i) row.cov.push_back(number(c[i]));
    out.push_back(std::move(row));
  });
  return out;
}

std::string to_csv(const std::vector<PredictedRow>& prediction) {
  std::string out =
      "record,time_s,measured_n,predicted_n,residual_n,base_predicted_n,reference_n\n";
  for (const PredictedRow& r : prediction) {
    fmt::format_to(std::back_inserter(out), "{},{:.6f},{:.6g},{:.6g},{:.6g},{:.6g},", r.record,
                   r.time_s, r.measured_n, r.predicted_n, r.measured_n - r.predicted_n, r.base_n);
    if (std::isfinite(r.reference_n))
      fmt::format_to(std::back_inserter(out), "{:.6g}", r.reference_n);
    out += '\n';
  }
  return out;
}

std::vector<PredictedRow> read_prediction(std::string_view text, const std::string& origin) {
  std::vector<PredictedRow> out;
  read_rows(text, origin, [&](const Cells& c) {
    PredictedRow row;
    row.record = integer<std::uint32_t>(c.at(0));
    row.time_s = number(c.at(1));
    row.measured_n = number(c.at(2));
    row.predicted_n = number(c.at(3));
    row.base_n = number(c.at(5));
    if (!c.at(6).empty()) row.reference_n = number(c.at(6));
    out.push_back(row);
  });
  return out;
}

}  // namespace dampline::app

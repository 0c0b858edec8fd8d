// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/print.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "app/verify/subjects.hpp"

namespace dampline::app {
namespace {

/// "table 3", "noise".
std::string heading(const std::vector<std::string>& tables, const std::string& title) {
  const bool numbered = tables.front().find_first_not_of("0123456789") == std::string::npos;
  if (!numbered) return fmt::format("\n{}: {}\n", tables.front(), title);
  return fmt::format("\nTable {}: {}\n", table_names(tables), title);
}

std::string bound_text(double bound) {
  return std::isfinite(bound) ? fmt::format("{:.1e}", bound) : "-";
}

template <class Figure>
const char* verdict(const Figure& figure) {
  if (!figure.met()) return "MISSED";
  return figure.is_bound() ? "met" : "-";
}

/// "-" where the windows do not give it.
std::string number(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

std::string line_of(const Estimate& estimate) {
  return fmt::format("    {:<38} {:>20} {:>9} {:>9}   {:>7} {:>7}  {}\n", estimate.method,
                     number(estimate.value, "{:.12g}"), number(estimate.error, "{:.1e}"),
                     number(estimate.spread, "{:.1e}"), bound_text(estimate.bound.error),
                     bound_text(estimate.bound.spread), verdict(estimate));
}

std::string lines_of(const ParameterFigures& parameter) {
  std::string out = fmt::format("  {} = {} {}\n", parameter.name, parameter.truth, parameter.unit);
  if (parameter.published_value || parameter.published_spread) {
    std::optional<double> error;
    if (parameter.published_value) {
      error = parameter.published_value->value - parameter.truth;
      if (parameter.truth != 0.0) error = *error / parameter.truth;
    }
    out += fmt::format(
        "    {:<38} {:>20} {:>9} {:>9}\n", "published", text_of(parameter.published_value),
        error ? fmt::format("{:.1e}", *error) : "-", text_of(parameter.published_spread));
  }
  for (const Estimate& estimate : parameter.estimates) out += line_of(estimate);
  return out;
}

/// D8 and D12 in windows, D16 over the run: the first estimates of recompute(); the others have no
/// bounds.
constexpr std::size_t kPromised = 3;

std::string published_text(const ParameterFigures& parameter) {
  const std::string value = parameter.published_value ? parameter.published_value->text : "";
  const std::string spread =
      parameter.published_spread ? fmt::format("({})", parameter.published_spread->text) : "";
  if (value.empty() && spread.empty()) return "-";
  return value + (value.empty() || spread.empty() ? "" : " ") + spread;
}

std::string row_of(const CaseFigures& figures, const ParameterFigures& parameter) {
  std::string out = fmt::format("| {} | {} | {} | {:g} {} | {} |", table_names(figures.tables),
                                markdown_cell(figures.title), parameter.name, parameter.truth,
                                parameter.unit, published_text(parameter));
  bool met = true;
  for (std::size_t m = 0; m < kPromised; ++m) {
    const Estimate& estimate = parameter.estimates[m];
    out += fmt::format(" {:.1e} ({:.1e}) |", estimate.error, estimate.spread);
    met = met && estimate.met();
  }
  const Estimate& last = parameter.estimates.back();
  out += last.method.ends_with("not gated")
             ? fmt::format(" {:.1e} ({:.1e}) |", last.error, last.spread)
             : " - |";
  return out + (met ? " yes |\n" : " **no** |\n");
}

std::string plain_table(const WaveletFigures& figures) {
  std::string out =
      "| Table | System | | Truth | Published (COV) | D8, windows: error (COV) | D12, windows | "
      "D16, recursive | D8 of 32 rows, not gated | met |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  bool any = false;
  for (const CaseFigures& one : figures.cases) {
    if (one.own_methods) continue;
    for (const ParameterFigures& parameter : one.parameters) {
      out += row_of(one, parameter);
      any = true;
    }
  }
  return any ? out : "";
}

std::string other_table(const CaseFigures& figures) {
  std::string out = fmt::format("\nTable {}: {}\n\n| | Truth | Published (COV) |",
                                figures.tables.front(), figures.title);
  std::string rule = "|---|---|---|";
  for (const Estimate& estimate : figures.parameters.front().estimates) {
    out += fmt::format(" {} |", estimate.method);
    rule += "---|";
  }
  out += "\n" + rule + "\n";
  for (const ParameterFigures& parameter : figures.parameters) {
    out += fmt::format("| {} | {:g} {} | {} |", parameter.name, parameter.truth, parameter.unit,
                       published_text(parameter));
    for (const Estimate& estimate : parameter.estimates) {
      const std::string spread =
          std::isfinite(estimate.spread) ? fmt::format(" ({:.1e})", estimate.spread) : "";
      out += fmt::format(" {:.1e}{} |", estimate.error, spread);
    }
    out += "\n";
  }
  return out;
}

std::string check_table(const std::vector<CheckGroup>& groups) {
  std::string out =
      "\n| Table | System | Figure | Published | Promised | Found | met "
      "|\n|---|---|---|---|---|---|---|\n";
  for (const CheckGroup& group : groups) {
    for (const Check& check : group.checks) {
      fmt::format_to(std::back_inserter(out), "| {} | {} | {} | {} | {} | {:.3g}{} | {} |\n",
                     table_names(group.tables), markdown_cell(group.title),
                     markdown_cell(check.what), text_of(check.published), bound_text(check),
                     check.found, check.unit == "1" ? "" : " " + check.unit,
                     check.met() ? (check.is_bound() ? "yes" : "-") : "**no**");
    }
  }
  return out;
}

/// What was assumed and why figures differ, as an item of a list.
std::string note_line(const std::vector<std::string>& tables, const std::string& title,
                      const std::string& conditions, const std::vector<std::string>& notes) {
  std::string out = fmt::format("- {}, {}:", table_names(tables), title);
  if (!conditions.empty()) out += " " + conditions + ".";
  for (const std::string& note : notes) out += " " + note;
  return out + "\n";
}

using Json = nlohmann::ordered_json;

Json maybe(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }
Json maybe(const std::optional<Printed>& figure) {
  return figure ? Json(figure->value) : Json(nullptr);
}
Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json json_of(const Estimate& estimate, const char* spread) {
  return {{"method", estimate.method},
          {"value", finite(estimate.value)},
          {"error", finite(estimate.error)},
          {spread, finite(estimate.spread)},
          {"rows", estimate.rows},
          {"windows", estimate.windows},
          {"error_bound", finite(estimate.bound.error)},
          {std::string{spread} + "_bound", finite(estimate.bound.spread)},
          {"met", estimate.met()}};
}

Json json_of(const ParameterFigures& parameter) {
  const char* const spread = parameter.truth == 0.0 ? "std" : "cov";
  Json out{{"name", parameter.name},
           {"unit", parameter.unit},
           {"truth", parameter.truth},
           {"published",
            {{"value", maybe(parameter.published_value)},
             {spread, maybe(parameter.published_spread)},
             {"printed_value", text_of(parameter.published_value)},
             {std::string{"printed_"} + spread, text_of(parameter.published_spread)}}},
           {"estimates", Json::array()}};
  for (const Estimate& estimate : parameter.estimates)
    out["estimates"].push_back(json_of(estimate, spread));
  return out;
}

Json json_of(const CaseFigures& figures) {
  Json out{{"tables", figures.tables},         {"title", figures.title},
           {"conditions", figures.conditions}, {"notes", figures.notes},
           {"step_s", figures.step_s},         {"samples", figures.samples},
           {"parameters", Json::array()}};
  for (const ParameterFigures& parameter : figures.parameters)
    out["parameters"].push_back(json_of(parameter));
  return out;
}

Json json_of(const CheckGroup& group) {
  Json out{{"tables", group.tables},
           {"title", group.title},
           {"notes", group.notes},
           {"checks", Json::array()}};
  for (const Check& check : group.checks) {
    out["checks"].push_back({{"what", check.what},
                             {"unit", check.unit},
                             {"published", maybe(check.published)},
                             {"printed", text_of(check.published)},
                             {"found", finite(check.found)},
                             {"at_most", maybe(check.at_most)},
                             {"at_least", maybe(check.at_least)},
                             {"met", check.met()}});
  }
  return out;
}

}  // namespace

std::string table_names(const std::vector<std::string>& tables) {
  std::string out;
  for (const std::string& name : tables) out += (out.empty() ? "" : ", ") + name;
  return out;
}

std::string bound_text(const Check& check) {
  std::string out;
  if (check.at_least) out += fmt::format(">= {:.4g}", *check.at_least);
  if (check.at_most) out += fmt::format("{}<= {:.4g}", out.empty() ? "" : ", ", *check.at_most);
  return out.empty() ? "-" : out;
}

std::string text_of(const std::optional<Printed>& figure) { return figure ? figure->text : "-"; }

std::string text_of(const CaseFigures& figures) {
  std::string out = heading(figures.tables, figures.title);
  fmt::format_to(std::back_inserter(out), "  {}\n  {} samples of {} s\n", figures.conditions,
                 figures.samples, figures.step_s);
  for (const std::string& note : figures.notes) out += "  " + note + "\n";
  out += fmt::format("    {:<38} {:>20} {:>9} {:>9}   {:>15}\n", "", "estimate", "error", "COV",
                     "bounds");
  for (const ParameterFigures& parameter : figures.parameters) out += lines_of(parameter);
  return out;
}

std::string text_of(const CheckGroup& group) {
  std::string out = heading(group.tables, group.title);
  for (const std::string& note : group.notes) out += "  " + note + "\n";
  for (const Check& check : group.checks) {
    fmt::format_to(std::back_inserter(out),
                   "    {:<58} {:>11.4g} {:<4} published {:>8}  {:<22} {}\n", check.what,
                   check.found, check.unit == "1" ? "" : check.unit, text_of(check.published),
                   bound_text(check), verdict(check));
  }
  return out;
}

std::string markdown_of(const WaveletFigures& figures) {
  std::string out = plain_table(figures);
  for (const CaseFigures& one : figures.cases) {
    if (one.own_methods) out += other_table(one);
  }
  if (!figures.groups.empty()) out += check_table(figures.groups);
  out += "\n";
  for (const CaseFigures& one : figures.cases)
    out += note_line(one.tables, one.title, one.conditions, one.notes);
  for (const CheckGroup& one : figures.groups)
    out += note_line(one.tables, one.title, "", one.notes);
  return out;
}

std::string json_of(const WaveletFigures& figures) {
  const Tally count = tally(figures);
  Json out{{"subject", "wavelet"},
           {"bounds", count.bound},
           {"bounds_met", count.met},
           {"cases", Json::array()},
           {"groups", Json::array()}};
  for (const CaseFigures& one : figures.cases) out["cases"].push_back(json_of(one));
  for (const CheckGroup& group : figures.groups) out["groups"].push_back(json_of(group));
  return out.dump(2) + "\n";
}

}  // namespace dampline::app

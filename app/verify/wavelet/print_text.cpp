// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "app/verify/wavelet/print.hpp"

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
      error = *parameter.published_value - parameter.truth;
      if (parameter.truth != 0.0) error = *error / parameter.truth;
    }
    out +=
        fmt::format("    {:<38} {:>20} {:>9} {:>9}\n", "published",
                    parameter.published_value ? fmt::format("{}", *parameter.published_value) : "-",
                    short_number(error), short_number(parameter.published_spread));
  }
  for (const Estimate& estimate : parameter.estimates) out += line_of(estimate);
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

std::string short_number(const std::optional<double>& value) {
  return value ? fmt::format("{:.1e}", *value) : "-";
}

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
                   check.found, check.unit == "1" ? "" : check.unit, short_number(check.published),
                   bound_text(check), verdict(check));
  }
  return out;
}

}  // namespace dampline::app

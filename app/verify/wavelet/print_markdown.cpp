// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <iterator>

#include "app/verify/wavelet/print.hpp"

namespace dampline::app {
namespace {

/// The bars of an absolute value would end a cell.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string{"\\|"} : std::string{c};
  return out;
}

/// D8 and D12 in windows, D16 over the run: the first estimates of recompute(); the others have no
/// bounds.
constexpr std::size_t kPromised = 3;

std::string published_text(const ParameterFigures& parameter) {
  const std::string value =
      parameter.published_value ? fmt::format("{:g}", *parameter.published_value) : "";
  const std::string spread =
      parameter.published_spread ? fmt::format("({:.1e})", *parameter.published_spread) : "";
  if (value.empty() && spread.empty()) return "-";
  return value + (value.empty() || spread.empty() ? "" : " ") + spread;
}

std::string row_of(const CaseFigures& figures, const ParameterFigures& parameter) {
  std::string out = fmt::format("| {} | {} | {} | {:g} {} | {} |", table_names(figures.tables),
                                cell(figures.title), parameter.name, parameter.truth,
                                parameter.unit, published_text(parameter));
  bool met = true;
  for (std::size_t m = 0; m < kPromised; ++m) {
    const Estimate& estimate = parameter.estimates[m];
    out += fmt::format(" {:.1e} ({:.1e}) |", estimate.error, estimate.spread);
    met = met && estimate.met();
  }
  return out + (met ? " yes |\n" : " **no** |\n");
}

std::string plain_table(const WaveletFigures& figures) {
  std::string out =
      "| Table | System | | Truth | Published (COV) | D8, windows: error (COV) | D12, windows | "
      "D16, "
      "recursive | met |\n|---|---|---|---|---|---|---|---|---|\n";
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
    for (const Estimate& estimate : parameter.estimates)
      out += fmt::format(" {:.1e} ({:.1e}) |", estimate.error, estimate.spread);
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
                     table_names(group.tables), cell(group.title), cell(check.what),
                     short_number(check.published), bound_text(check), check.found,
                     check.unit == "1" ? "" : " " + check.unit,
                     check.met() ? (check.is_bound() ? "yes" : "-") : "**no**");
    }
  }
  return out;
}

}  // namespace

std::string markdown_of(const WaveletFigures& figures) {
  std::string out = plain_table(figures);
  for (const CaseFigures& one : figures.cases) {
    if (one.own_methods) out += other_table(one);
  }
  if (!figures.groups.empty()) out += check_table(figures.groups);
  return out;
}

}  // namespace dampline::app

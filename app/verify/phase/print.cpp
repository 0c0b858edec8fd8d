// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/verify/phase/rows.hpp"

namespace dampline::app {
namespace {

std::string number(const std::optional<double>& x) { return x ? fmt::format("{:.4g}", *x) : "-"; }

std::string found(const PhaseRow& row) {
  if (!row.found) return "none";
  return row.deviation ? fmt::format("{:.4g} +- {:.1g}", *row.found, *row.deviation)
                       : number(row.found);
}

std::string bound(const PhaseRow& row) {
  if (row.at_least && row.at_most)
    return fmt::format("{:.4g} ... {:.4g}", *row.at_least, *row.at_most);
  if (row.at_least) return fmt::format(">= {:.4g}", *row.at_least);
  return row.at_most ? fmt::format("<= {:.4g}", *row.at_most) : "-";
}

const char* verdict(const PhaseRow& row) {
  if (!row.at_least && !row.at_most) return "";
  return row.met() ? "met" : "NOT MET";
}

}  // namespace

std::string text_of(const std::vector<PhaseRow>& rows) {
  std::string text;
  std::string table;
  for (const PhaseRow& row : rows) {
    if (row.table != table) text += fmt::format("{}{}\n", table.empty() ? "" : "\n", row.table);
    table = row.table;
    text += fmt::format("  {}\n    published {}, found {} {}", row.what, number(row.published),
                        found(row), row.found ? row.unit : "");
    if (row.at_least || row.at_most)
      text += fmt::format("; demanded {}: {}", bound(row), verdict(row));
    text += row.remark.empty() ? "\n" : fmt::format("\n    {}\n", row.remark);
  }
  return text;
}

std::string markdown_of(const std::vector<PhaseRow>& rows) {
  std::string text;
  std::string table;
  for (const PhaseRow& row : rows) {
    if (row.table != table)
      text += fmt::format(
          "{}### {}\n\n| case | published | found | unit | demanded | | remark |\n"
          "|---|---|---|---|---|---|---|\n",
          table.empty() ? "" : "\n", row.table);
    table = row.table;
    std::string what = row.what + " | " + number(row.published) + " | ";
    for (std::size_t at = what.find("|1"); at != std::string::npos; at = what.find("|1", at + 3))
      what.replace(at, 1, "\\|");  // a magnitude, not the end of a cell
    for (std::size_t at = what.find("_c|"); at != std::string::npos; at = what.find("_c|", at + 3))
      what.replace(at + 2, 1, "\\|");
    text += fmt::format("| {}{} | {} | {} | {} | {} |\n", what, found(row), row.unit, bound(row),
                        verdict(row), row.remark);
  }
  return text;
}

std::string json_of(const std::vector<PhaseRow>& rows) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  const auto value = [](const std::optional<double>& x) {
    return x ? nlohmann::ordered_json(*x) : nlohmann::ordered_json(nullptr);
  };
  for (const PhaseRow& row : rows)
    out.push_back({{"table", row.table},
                   {"what", row.what},
                   {"unit", row.unit},
                   {"published", value(row.published)},
                   {"found", value(row.found)},
                   {"std", value(row.deviation)},
                   {"at_least", value(row.at_least)},
                   {"at_most", value(row.at_most)},
                   {"met", row.met()},
                   {"remark", row.remark}});
  return nlohmann::ordered_json{{"figures", out}}.dump(2) + "\n";
}

}  // namespace dampline::app

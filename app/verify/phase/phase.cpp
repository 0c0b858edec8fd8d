// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "app/error.hpp"
#include "app/report/svg/figure.hpp"
#include "app/verify/phase/pictures.hpp"
#include "app/verify/phase/rows.hpp"
#include "app/verify/subjects.hpp"

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

constexpr int kRuns = 10;  // the benchmark takes a hundred

/// Computed once: rows and figures need them.
const std::vector<FrictionFamily>& families() {
  static const std::vector<FrictionFamily> all = friction_families();
  return all;
}

constexpr std::string_view kFamiliesText =
    "g(y) at the publication's own inputs, from 24 starts within 3 m and 3 m/s (from rest next to "
    "nothing moves): a curve per frequency, per amplitude and per mean of the input, the other two "
    "in all their values; beside each what is between it and the published law |1 + y / 0.5|, with "
    "bands of two stated deviations. The node beside the law's kink at -0.5 is off, since a curve "
    "is straight between its nodes. Nodes where nothing moved both ways are missing.";

/// The simulated systems in their three planes, for the page.
void put_pictures(const VerifyOptions& options) {
  put(options, "\n### Phase planes and sections of the simulated cases\n\n");
  int number = 0;
  for (const PhasePictures& pictures : phase_pictures()) {
    put_figure(
        options,
        figure(pictures.plot, fmt::format("planes-{}", ++number),
               fmt::format(
                   "{}: three trajectories under 0.5 + 3 sin(0.8 t) m/s² on the three planes, "
                   "and the stroboscopic section of 16 starts at the input's phase 0, {} "
                   "points that move. The last panel is the section seen along its best plane: "
                   "a linear system's points are a straight line (rms distance {:.2g} of "
                   "rms y'').",
                   pictures.name, pictures.points, pictures.off_plane)));
  }
}

std::string text_in_form(const std::vector<PhaseRow>& rows, const VerifyOptions& options) {
  if (options.json) return json_of(rows);
  return options.markdown ? markdown_of(rows) : text_of(rows);
}

/// Measured records, which nothing is promised of.
int verify_records(const VerifyOptions& options) {
  put(options, text_in_form(record_rows(options.records), options));
  if (options.page == nullptr) return 0;
  int number = 0;
  for (const MeasuredRecord& record : options.records)
    put_figure(options,
               figure(plot_measured(record), fmt::format("record-{}", ++number),
                      record.name + ": motion and force on the three planes, and the sections at "
                                    "eight phases where the motion repeats."));
  return 0;
}

using Table = std::pair<std::string, std::function<std::vector<PhaseRow>()>>;

const std::vector<Table>& tables() {
  static const std::vector<Table> all{{"resonance", [] { return resonance_rows(); }},
                                      {"planarity", [] { return planarity_rows(3); }},
                                      {"linearity", [] { return linearity_rows(kRuns); }},
                                      {"friction", [] { return friction_rows(kRuns); }},
                                      {"figures", [] { return figure_rows(families()); }}};
  return all;
}

void check_names(const std::vector<std::string>& wanted) {
  for (const std::string& name : wanted) {
    const bool known = std::any_of(tables().begin(), tables().end(),
                                   [&](const Table& table) { return table.first == name; });
    if (!known)
      throw UsageError{fmt::format(
          "verify phase --table: found '{}', expected resonance, planarity, linearity, friction or "
          "figures",
          name)};
  }
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
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", markdown_cell(row.what),
                        number(row.published), found(row), row.unit, bound(row), verdict(row),
                        row.remark);
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

int verify_phase(const VerifyOptions& options) {
  check_names(options.tables);
  if (!options.records.empty()) return verify_records(options);
  std::vector<PhaseRow> rows;
  for (const auto& [name, make] : tables()) {
    if (!options.wants(name)) continue;
    for (PhaseRow& row : make()) rows.push_back(std::move(row));
  }
  put(options, text_in_form(rows, options));
  if (options.wants("figures") && options.page != nullptr) {
    put_figure(options, figure(plot_families(families()), "friction", kFamiliesText));
    put_pictures(options);
  }
  return std::all_of(rows.begin(), rows.end(), [](const PhaseRow& row) { return row.met(); }) ? 0
                                                                                              : 1;
}

}  // namespace dampline::app

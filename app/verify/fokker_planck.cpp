// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "app/error.hpp"
#include "app/report/svg/figure.hpp"
#include "app/verify/fokker_planck_cases.hpp"
#include "app/verify/subjects.hpp"

namespace dampline::app {
namespace {

constexpr std::string_view kFigureText =
    "Damping force over velocity: what the publication's table prints, over what its method finds "
    "in nine simulations of 300 s with the forces that the table gives at v = 0, the region around "
    "v = 0 left out. Towards the ends, where hardly any sample is, a run of this length knows the "
    "force to some kilonewtons; the published points scatter by less than one newton. The "
    "published -1.98199 between -1.87198 and -1.87200 is a misprint of table 2.";

const char* standing(const FokkerPlanckFigure& figure) {
  if (!figure.promised) return "";
  return figure.met ? "met" : "MISSED";
}

std::string figures_text(const FokkerPlanckCases& cases, bool markdown) {
  std::string out;
  if (markdown) out += "| figure | published | computed | | |\n|--|--|--|--|--|\n";
  for (const FokkerPlanckFigure& f : cases.figures) {
    out += markdown ? fmt::format("| {} | {} | {} | {} | {} |\n", markdown_cell(f.quantity),
                                  f.published, f.computed, standing(f), markdown_cell(f.remark))
                    : fmt::format("{:<62} published {:>18}   computed {:>20}  {}\n    {}\n",
                                  f.quantity, f.published, f.computed, standing(f), f.remark);
  }
  return out;
}

std::string of_runs(const OverRuns& found) {
  return fmt::format("{:.0f} +- {:.0f}", found.mean, found.std);
}

/// "+0.00290 ... +0.00580", or what line 11 is.
std::string interval_of(const PaperLine& line) {
  if (line.from_mps == line.to_mps) return "jump at v = 0";
  return fmt::format("{:+.5f} ... {:+.5f}", line.from_mps, line.to_mps);
}

/// Off the published force, with the deviation of the mean of nine runs; a figure that is
/// misprinted is compared as it stands.
std::string off_published(const PaperLine& line) {
  const double published_n = 1e3 * Printed{line.published->figures[3]}.value;
  return fmt::format("{:+.1f} +- {:.1f}", 100.0 * (line.force_n.mean / published_n - 1.0),
                     100.0 * line.force_n.std / std::sqrt(static_cast<double>(kRunsOfTable)) /
                         std::abs(published_n));
}

/// Line by line as the publication's tables; ours without the region around v = 0, whose segments
/// have slope 0, and with it for one run.
std::string table_text(const PaperTable& table, bool markdown) {
  std::string out =
      fmt::format("\n{}Table {}: {}\n", markdown ? "### " : "", table.name, table.caption);
  const char* const format = markdown
                                 ? "| {} | {} | {} | {} | {} | {} | {} | {} |\n"
                                 : "{:>20} {:>12} {:>9}   {:>22} {:>16} {:>14} {:>14} {:>12}\n";
  const auto print = [&](const auto&... cells) {
    out += fmt::format(fmt::runtime(format), cells...);
  };
  out += fmt::format(
      "{}Ours: nine simulated runs of 300 s under white input, whose force is the table's own jump "
      "at v = 0, {:.2f} and -{:.2f} N; +-: of a run, in the column of deviations of the mean.\n",
      markdown ? "\n" : "", table.simulated_n[1], table.simulated_n[0]);
  if (markdown) out += "\n";
  print("published, m/s", "slope, N s/m", "force, N", "ours, m/s", "slope, N s/m", "force, N",
        "off, %", "v = 0 in, N");
  if (markdown) out += "|--|--|--|--|--|--|--|--|\n";
  for (const std::size_t side : {std::size_t{1}, std::size_t{0}}) {
    for (std::size_t i = 0; i < table.lines[side].size(); ++i) {
      const PaperLine& line = table.lines[side][i];
      const std::vector<std::string>& published = line.published->figures;
      const double whole_mps2 = i < kPaperSegments ? table.whole.segments[side][i].alpha_mps2
                                                   : table.whole.offset_mps2[side];
      print(fmt::format("{} ... {}", published[0], published[1]), published[2],
            fmt::format("{:.2f}", 1e3 * Printed{published[3]}.value), interval_of(line),
            line.from_mps == line.to_mps ? "-" : of_runs(line.slope_nspm), of_runs(line.force_n),
            off_published(line), fmt::format("{:.0f}", table.half_mass_kg * whole_mps2));
    }
  }
  return out;
}

nlohmann::json json_of(const PaperTable& table) {
  nlohmann::json rows = nlohmann::json::array();
  for (const std::size_t side : {std::size_t{1}, std::size_t{0}}) {
    for (const PaperLine& line : table.lines[side]) {
      rows.push_back({{"from_mps", line.from_mps},
                      {"to_mps", line.to_mps},
                      {"slope_nspm", line.slope_nspm.mean},
                      {"slope_std_nspm", line.slope_nspm.std},
                      {"force_n", line.force_n.mean},
                      {"force_std_n", line.force_n.std},
                      {"published_force_n", 1e3 * Printed{line.published->figures[3]}.value},
                      {"printed", line.published->figures}});
    }
  }
  return {{"table", table.name}, {"caption", table.caption}, {"rows", rows}};
}

std::string json_text(const FokkerPlanckCases& cases, const VerifyOptions& options) {
  nlohmann::json out{{"subject", "fokker-planck"}};
  out["figures"] = nlohmann::json::array();
  for (const FokkerPlanckFigure& f : cases.figures) {
    nlohmann::json figure{{"quantity", f.quantity},
                          {"published", f.published},
                          {"computed", f.computed},
                          {"remark", f.remark}};
    if (f.promised) figure["met"] = f.met;
    out["figures"].push_back(figure);
  }
  out["tables"] = nlohmann::json::array();
  for (const PaperTable& table : cases.tables) {
    if (options.wants(table.name)) out["tables"].push_back(json_of(table));
  }
  return out.dump(2) + "\n";
}

}  // namespace

int verify_fokker_planck(const VerifyOptions& options) {
  for (const std::string& name : options.tables) {
    if (name != "1" && name != "2") {
      throw UsageError{
          fmt::format("verify fokker-planck: found --table {}, expected 1 or 2", name)};
    }
  }
  const FokkerPlanckCases cases = fokker_planck_cases();
  if (options.json) {
    put(options, json_text(cases, options));
  } else {
    if (options.tables.empty()) put(options, figures_text(cases, options.markdown));
    for (const PaperTable& table : cases.tables) {
      if (!options.wants(table.name)) continue;
      put(options, table_text(table, options.markdown));
      put_figure(options, figure(plot_table(table), "table-" + table.name, kFigureText));
    }
  }
  const bool met = std::all_of(cases.figures.begin(), cases.figures.end(),
                               [](const FokkerPlanckFigure& f) { return f.met; });
  return met ? 0 : 1;
}

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "app/error.hpp"
#include "app/verify/fokker_planck_cases.hpp"
#include "app/verify/subjects.hpp"

namespace dampline::app {
namespace {

const char* standing(const FokkerPlanckFigure& figure) {
  if (!figure.promised) return "";
  return figure.met ? "met" : "MISSED";
}

void print_figures(const FokkerPlanckCases& cases, bool markdown) {
  if (markdown) fmt::print("| figure | published | computed | | |\n|--|--|--|--|--|\n");
  for (const FokkerPlanckFigure& f : cases.figures) {
    if (markdown) {
      fmt::print("| {} | {} | {} | {} | {} |\n", markdown_cell(f.quantity), f.published, f.computed,
                 standing(f), markdown_cell(f.remark));
    } else {
      fmt::print("{:<62} published {:>18}   computed {:>20}  {}\n    {}\n", f.quantity, f.published,
                 f.computed, standing(f), f.remark);
    }
  }
}

/// Interval, slope, force, as the publication's tables; slopes and forces with the region around
/// v = 0 left out, and forces as published.
void print_table(const PaperTable& table, bool markdown) {
  fmt::print("\n{}Table {}: {}\n", markdown ? "### " : "", table.name, table.caption);
  if (markdown) {
    fmt::print(
        "\n| interval, m/s | slope, N s/m | force, N | force with v = 0 left in, N |\n"
        "|--|--|--|--|\n");
  } else {
    fmt::print("{:>22} {:>14} {:>12} {:>28}\n", "interval, m/s", "slope, N s/m", "force, N",
               "force with v = 0 left in, N");
  }
  for (const std::size_t side : {std::size_t{1}, std::size_t{0}}) {
    const double sign = side == 1 ? 1.0 : -1.0;
    for (std::size_t i = 0; i < kPaperSegments; ++i) {
      const PaperSegment& s = table.excluded.segments[side][i];
      const double whole_n = table.half_mass_kg * table.whole.segments[side][i].alpha_mps2;
      const std::string interval =
          fmt::format("{:+.5f} ... {:+.5f}", sign * s.from_mps, sign * s.to_mps);
      fmt::print(fmt::runtime(markdown ? "| {} | {:.0f} | {:.0f} | {:.0f} |\n"
                                       : "{:>22} {:>14.0f} {:>12.0f} {:>28.0f}\n"),
                 interval, sign * table.half_mass_kg * s.slope_ps,
                 table.half_mass_kg * s.alpha_mps2, whole_n);
    }
  }
}

nlohmann::json json_of(const PaperTable& table) {
  nlohmann::json rows = nlohmann::json::array();
  for (const std::size_t side : {std::size_t{1}, std::size_t{0}}) {
    const double sign = side == 1 ? 1.0 : -1.0;
    for (std::size_t i = 0; i < kPaperSegments; ++i) {
      const PaperSegment& s = table.excluded.segments[side][i];
      rows.push_back(
          {{"from_mps", sign * s.from_mps},
           {"to_mps", sign * s.to_mps},
           {"slope_nspm", sign * table.half_mass_kg * s.slope_ps},
           {"force_n", table.half_mass_kg * s.alpha_mps2},
           {"force_with_zero_n", table.half_mass_kg * table.whole.segments[side][i].alpha_mps2}});
    }
  }
  return {{"table", table.name}, {"caption", table.caption}, {"rows", rows}};
}

void print_json(const FokkerPlanckCases& cases, const VerifyOptions& options) {
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
  fmt::print("{}\n", out.dump(2));
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
  if (!options.quiet && options.json) {
    print_json(cases, options);
  } else if (!options.quiet) {
    if (options.tables.empty()) print_figures(cases, options.markdown);
    for (const PaperTable& table : cases.tables) {
      if (options.wants(table.name)) print_table(table, options.markdown);
    }
  }
  const bool met = std::all_of(cases.figures.begin(), cases.figures.end(),
                               [](const FokkerPlanckFigure& f) { return f.met; });
  return met ? 0 : 1;
}

}  // namespace dampline::app

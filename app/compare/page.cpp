// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/compare/compare.hpp"
#include "app/compare/series.hpp"
#include "app/report/assets.hpp"
#include "app/report/html.hpp"
#include "app/report/plots.hpp"
#include "app/report/svg/figure.hpp"
#include "app/report/svg/panel.hpp"

namespace dampline::app::compare {
namespace {

using svg::Ink;

constexpr std::array kInks{Ink::kBlue, Ink::kOrange, Ink::kGreen, Ink::kPink, Ink::kGrey};
constexpr std::int64_t kDayNs = 86'400'000'000'000;

/// Where each run stands on the horizontal axis.
struct Places {
  std::string label;
  std::vector<double> at;
};

/// By the date, in days from the first one's midnight; by number where a run has no date.
Places places_of(const std::vector<Run>& runs) {
  Places out;
  std::int64_t first_ns = 0;
  bool dated = true;
  for (const Run& run : runs) {
    const auto start_ns = run.result.origin.recorded.start_ns;
    dated = dated && start_ns.has_value();
    if (start_ns && (first_ns == 0 || *start_ns < first_ns)) first_ns = *start_ns;
  }
  const std::int64_t midnight_ns = first_ns - first_ns % kDayNs;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto start_ns = runs[i].result.origin.recorded.start_ns.value_or(0);
    out.at.push_back(dated ? static_cast<double>(start_ns - midnight_ns) / double(kDayNs)
                           : static_cast<double>(i + 1));
  }
  out.label = dated ? fmt::format("days since {}, 0 h UTC", utc_text(midnight_ns).substr(0, 10))
                    : "run, in the order given: not all are dated";
  return out;
}

using Pick = std::optional<Parameter> (*)(const RunResult&);

std::map<std::string, Series> series_of(const std::vector<Run>& runs, const Places& places,
                                        Pick pick) {
  std::map<std::string, Series> out;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Origin& origin = runs[i].result.origin;
    std::string name = origin.vehicle;
    if (!origin.truck.empty()) name += (name.empty() ? "" : ", ") + origin.truck;
    if (const auto found = pick(runs[i].result); found)
      out[name].points.emplace_back(places.at[i], *found);
  }
  for (auto& [name, series] : out)
    std::sort(series.points.begin(), series.points.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
  return out;
}

PlotUnit unit_of(const std::map<std::string, Series>& all) {
  double largest = 0.0;
  std::string unit;
  for (const auto& [name, series] : all)
    for (const auto& [x, p] : series.points) {
      largest = std::max(largest, std::abs(p.value));
      unit = p.unit;
    }
  return plot_unit(unit, largest);
}

std::string plot_of(const std::vector<Run>& runs, const std::string& what, Pick pick) {
  const Places places = places_of(runs);
  const auto all = series_of(runs, places, pick);
  if (all.empty()) return "";
  const PlotUnit unit = unit_of(all);
  svg::Panel panel{{places.label}, {fmt::format("{} ({})", what, unit.name)}};
  std::size_t i = 0;
  for (const auto& [name, series] : all)
    add_series(series, unit.factor, kInks[i++ % kInks.size()],
               name.empty() && all.size() > 1 ? "no vehicle named" : name, panel);
  return fmt::format("<section><h2>{}</h2>\n{}</section>\n", escape_html(what),
                     figure({{panel}}, what.substr(0, what.find(' ')),
                            "Dots with bars and band: ± 2 standard deviations."));
}

std::string table_of(const std::vector<std::vector<std::string>>& rows, std::size_t numbers) {
  if (rows.empty()) return "";
  return html_table(rows.front(), {rows.begin() + 1, rows.end()}, numbers);
}

/// Tables of many columns, whose short words stay whole.
constexpr std::string_view kWide = "body { max-width: 76rem; }";

}  // namespace

std::string make_page(const std::vector<Run>& runs) {
  const std::string title = fmt::format("{} runs compared", runs.size());
  std::string body = table_of(overview(runs), 0);
  for (const std::string& note : notes_on(runs))
    body += fmt::format("<p class=\"note\">{}</p>\n", escape_html(note));
  body += plot_of(runs, "Friction level", level_of);
  body += plot_of(runs, "Stiffness", stiffness_of);
  if (const auto rows = difference_table(runs); !rows.empty())
    body += fmt::format(
        "<section><h2>Difference to {}</h2>\n{}<p class=\"note\">In brackets: of the first run's "
        "value, and in standard deviations of the difference.</p></section>\n",
        escape_html(runs.front().name), table_of(rows, rows.front().size() - 1));
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>dampline: {0}</title>\n{1}<style>{3}</style></head><body>\n<main>\n"
      "<h1>dampline: {0}</h1>\n{2}</main>\n{4}</body></html>\n",
      escape_html(title), page_head(), body, kWide, page_scripts());
}

}  // namespace dampline::app::compare

// SPDX-License-Identifier: MIT
#include "app/fleet/page/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <tuple>

#include "app/fleet/page/view.hpp"
#include "app/report/html.hpp"
#include "app/report/plots.hpp"
#include "app/report/svg/figure.hpp"
#include "app/report/svg/panel.hpp"
#include "app/run/json.hpp"
#include "app/text/format.hpp"

namespace dampline::app::fleet::page {
namespace {

using svg::Ink;
using svg::Point;

constexpr double kBandStds = 2.0;
constexpr std::size_t kMostPanels = 4;    // loads with a drawing of their own
constexpr std::size_t kMostPlaces = 400;  // of a line over thousands of trucks

/// A value of each truck of a load, the lowest first.
struct Ranked {
  struct One {
    Estimate value;
    bool is_outlier{false};
  };
  std::vector<One> list;
};

/// What marks the outliers among the trucks of a load.
using Outside = std::set<std::tuple<std::string, std::string, std::string, double, std::string>>;

Outside outside_of(const Fleet& fleet) {
  Outside out;
  for (const Outlier& o : fleet.outliers)
    out.emplace(o.vehicle, o.truck, o.load.name, o.load.moving_mass_kg, o.quantity);
  return out;
}

Ranked ranked(std::span<const TruckFigures> trucks, const Outside& outside, std::size_t quantity,
              double factor) {
  Ranked out;
  for (const TruckFigures& t : trucks) {
    const std::optional<Estimate>& value = t.values[quantity];
    if (!value) continue;
    const bool is_outlier =
        outside.contains({t.vehicle, t.truck, t.load.name, t.load.moving_mass_kg,
                          std::string{kQuantities[quantity].name}});
    out.list.push_back({{factor * value->value, factor * value->std}, is_outlier});
  }
  std::sort(out.list.begin(), out.list.end(), [](const Ranked::One& a, const Ranked::One& b) {
    return a.value.value < b.value.value;
  });
  return out;
}

svg::Panel rank_panel(const Ranked& ranked, const std::string& label) {
  svg::Panel panel{{"trucks, the lowest first"}, {label}};
  const std::size_t count = ranked.list.size();
  const std::size_t stride = std::max<std::size_t>(1, count / kMostPlaces);
  std::vector<Point> middle;
  std::vector<Point> lower;
  std::vector<Point> upper;
  std::vector<Point> outside;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [value, is_outlier] = ranked.list[i];
    const auto x = static_cast<double>(i + 1);
    if (is_outlier) outside.push_back({x, value.value});
    if (i % stride != 0 && i + 1 != count) continue;
    middle.push_back({x, value.value});
    lower.push_back({x, value.value - kBandStds * value.std});
    upper.push_back({x, value.value + kBandStds * value.std});
  }
  if (count > 1) panel.band(lower, upper, Ink::kBlue);
  if (count > 1)
    panel.line(middle, {Ink::kBlue, 2.0}, "a truck's place");
  else
    panel.dots(middle, Ink::kBlue, 4.0, "a truck");
  if (!outside.empty()) panel.dots(outside, Ink::kOrange, 4.0, "outlier");
  return panel;
}

std::string load_plots(const Fleet& fleet) {
  const Outside outside = outside_of(fleet);
  std::vector<std::span<const TruckFigures>> loads;
  for (auto from = fleet.figures.begin(); from != fleet.figures.end();) {
    const auto to = std::find_if(from, fleet.figures.end(),
                                 [&](const TruckFigures& t) { return !(t.load == from->load); });
    loads.emplace_back(from, to);
    from = to;
  }
  std::stable_sort(loads.begin(), loads.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  std::string out;
  for (std::size_t i = 0; i < std::min(loads.size(), kMostPanels); ++i) {
    const std::span<const TruckFigures> trucks = loads[i];
    const auto norm = std::find_if(fleet.norms.begin(), fleet.norms.end(), [&](const Norm& n) {
      return n.load == trucks.front().load && n.quantity == kQuantities[kLevel].name;
    });
    if (norm == fleet.norms.end()) continue;
    const double median_n = norm->median;
    const PlotUnit unit = plot_unit("N", median_n);
    Plot plot{{rank_panel(ranked(trucks, outside, kLevel, unit.factor),
                          fmt::format("level ({})", unit.name))},
              true};
    constexpr double kPercent = 100.0;
    const Ranked trends = ranked(trucks, outside, kTrend, kPercent / median_n);
    if (!trends.list.empty())
      plot.panels.push_back(rank_panel(trends, "trend (% of the median level a year)"));
    out += fmt::format(
        "<section><h2>Load: {}, {} trucks</h2>\n{}</section>\n",
        escape_html(load_text(trucks.front().load)), format_count(trucks.size()),
        figure(plot, fmt::format("load{}", i + 1),
               "Every truck once, by its level of the newest week and by its trend over a year. "
               "The band is ± 2 standard deviations of a truck's own value."));
  }
  if (loads.size() > kMostPanels)
    out += fmt::format("<p class=\"note\">{} loads with fewer trucks are in the tables.</p>\n",
                       loads.size() - kMostPanels);
  return out;
}

std::string answer(const std::string& name, const std::string& value, const std::string& remark) {
  return fmt::format("<div><dt>{}</dt><dd class=\"value\">{}</dd><dd>{}</dd></div>\n",
                     escape_html(name), escape_html(value), escape_html(remark));
}

std::string counted(std::int64_t count) { return format_count(static_cast<std::uint64_t>(count)); }

std::string answers(const Fleet& fleet) {
  std::set<std::string> cars_outside;
  for (const Outlier& o : fleet.outliers) cars_outside.insert(o.vehicle);
  std::string out = "<dl class=\"answer\">\n";
  out += answer("Cars", counted(fleet.cars),
                fmt::format("{} trucks, {} segments, {} h of motion", counted(fleet.trucks),
                            counted(fleet.segments), counted(std::llround(fleet.hours))));
  out += answer("Outliers", counted(std::int64_t(cars_outside.size())),
                fmt::format("cars, by {} of their figures", counted(std::ssize(fleet.outliers))));
  out +=
      answer("Alarms", counted(fleet.alarmed.all), "trucks in whose newest segment one was raised");
  out += answer("Silent", counted(fleet.silent.all),
                "trucks without contact in the week before the newest one");
  out += answer("Faulty", counted(fleet.faulty.all),
                "trucks whose newest segment is spoiled by faults of the data");
  return out + "</dl>\n";
}

std::string norm_table(const Fleet& fleet) {
  std::vector<std::vector<std::string>> rows;
  for (const Norm& n : fleet.norms)
    rows.push_back({load_text(n.load), n.quantity, counted(n.trucks),
                    quantity_text(n.median, n.scatter, n.unit)});
  if (rows.empty()) return "";
  return "<section><h2>The fleet's norms</h2>\n" +
         html_table({"load", "what", "trucks", "median ± scatter of trucks"}, rows, 0) +
         "<p class=\"note\">Level and stiffness are those of a truck's newest week; the change is "
         "from the year before it. The scatter is 0.7413 times the distance of the quartiles, a "
         "standard deviation that outliers do not move.</p></section>\n";
}

std::string contact_section(const std::string& title, const First<TruckContact>& list, Kind kind) {
  if (list.rows.empty()) return "";
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> links;
  for (const TruckContact& t : list.rows) {
    rows.push_back({vehicle_text(t.vehicle), t.truck, t.last_contact_utc, counted(t.segments),
                    counted(t.faulty_segments), fmt::format("{:.1f}", t.hours),
                    plot_label(t.newest_trust), plot_label(t.newest_alarms)});
    links.push_back(car_link(t.vehicle, kind));
  }
  std::string out = fmt::format("<section><h2>{}: {}</h2>\n", title, counted(list.all));
  out += html_table({"car", "truck", "last contact (UTC)", "segments", "faulty", "hours",
                     "newest segment", "its alarms"},
                    rows, 0, {}, links);
  if (list.all > std::int64_t(list.rows.size()))
    out += fmt::format("<p class=\"note\">The first {}; truck.csv has all.</p>\n", rows.size());
  return out + "</section>\n";
}

std::string outlier_section(const Fleet& fleet, Kind kind) {
  if (fleet.outliers.empty())
    return "<section><h2>Outliers</h2>\n<p>None of the trucks lies outside of its fleet. Where a "
           "load has fewer than 20 trucks, none is looked for.</p></section>\n";
  return fmt::format(
      "<section><h2>Outliers: {}</h2>\n{}<p class=\"note\">Farther than 4.5 standard deviations, "
      "of "
      "the truck's value and of the fleet's scatter together, from the median of the trucks with "
      "the same load.{}</p></section>\n",
      counted(std::ssize(fleet.outliers)), outlier_table(fleet.outliers, kind),
      fleet.outliers.size() > 50 ? " The first 50; outlier.csv has all." : "");
}

std::string tables_note(Kind kind) {
  std::string out = "<footer class=\"note\"><p>Tables (CSV): ";
  const char* between = "";
  for (const char* view : {"truck", "trend", "outlier", "norm"}) {
    out += kind == Kind::kServed ? fmt::format("{0}<a href=\"/{1}.csv\">{1}.csv</a>", between, view)
                                 : fmt::format("{}{}.csv", between, view);
    between = ", ";
  }
  return out + (kind == Kind::kServed ? "; <a href=\"/metrics\">metrics</a></p></footer>\n"
                                      : "</p></footer>\n");
}

}  // namespace

std::string fleet_page(const Fleet& fleet, const std::string& where, Kind kind) {
  std::string body =
      fmt::format("<p class=\"lead\">{} cars, newest contact {} UTC.</p>\n", counted(fleet.cars),
                  fleet.last_contact_utc.empty() ? "unknown" : fleet.last_contact_utc);
  body += answers(fleet);
  if (fleet.refused > 0)
    body += fmt::format(
        "<p class=\"warning\">{} files held no state that could be read: table "
        "<code>refused</code>.</p>\n",
        counted(fleet.refused));
  body += outlier_section(fleet, kind);
  body += load_plots(fleet);
  body += norm_table(fleet);
  body += contact_section("Trucks with alarms", fleet.alarmed, kind);
  body += contact_section("Silent trucks", fleet.silent, kind);
  body += contact_section("Trucks with faults of the data", fleet.faulty, kind);
  body += fmt::format("<p class=\"note\">From {}.</p>\n", escape_html(where));
  return framed("the fleet", body + tables_note(kind), kind);
}

std::string cars_page(const First<CarRow>& cars, std::int64_t first) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> links;
  for (const CarRow& c : cars.rows) {
    rows.push_back({vehicle_text(c.vehicle), c.last_contact_utc, counted(c.trucks),
                    counted(c.segments), counted(c.faulty_segments),
                    c.outliers == 0 ? "" : counted(c.outliers)});
    links.push_back(car_link(c.vehicle, Kind::kServed));
  }
  std::string pages = "<nav aria-label=\"Pages of the list\"><p>";
  if (first > 0)
    pages += fmt::format("<a href=\"/cars?from={}\">before</a> ",
                         std::max<std::int64_t>(0, first - kCarsOnPage));
  pages += fmt::format("{} to {} of {}", counted(std::min(first + 1, cars.all)),
                       counted(first + std::int64_t(cars.rows.size())), counted(cars.all));
  if (first + kCarsOnPage < cars.all)
    pages += fmt::format(" <a href=\"/cars?from={}\">after</a>", first + kCarsOnPage);
  pages += "</p></nav>\n";
  return framed("all cars",
                pages +
                    html_table({"car", "last contact (UTC)", "trucks", "segments", "faulty",
                                "figures outside"},
                               rows, 0, {}, links) +
                    pages,
                Kind::kServed);
}

std::string fleet_text(const Fleet& fleet) {
  std::string out = fmt::format(
      "{} cars, {} trucks, {} segments, {:.0f} h; newest contact {} UTC\n{} trucks with "
      "alarms, {} silent for a week, {} with faults of the data, {} files refused\n",
      counted(fleet.cars), counted(fleet.trucks), counted(fleet.segments), fleet.hours,
      fleet.last_contact_utc.empty() ? "unknown" : fleet.last_contact_utc,
      counted(fleet.alarmed.all), counted(fleet.silent.all), counted(fleet.faulty.all),
      counted(fleet.refused));
  std::vector<std::vector<std::string>> norms{{"load", "what", "trucks", "median and scatter"}};
  for (const Norm& n : fleet.norms)
    norms.push_back({load_text(n.load), n.quantity, counted(n.trucks),
                     quantity_text(n.median, n.scatter, n.unit)});
  if (norms.size() > 1) out += "\n" + columns_text(norms);
  std::vector<std::vector<std::string>> outliers{
      {"outlier", "truck", "load", "what", "value", "the fleet's", "deviations", "last contact"}};
  for (const Outlier& o : fleet.outliers)
    outliers.push_back({vehicle_text(o.vehicle), o.truck, load_text(o.load), o.quantity,
                        quantity_text(o.value.value, o.value.std, o.unit),
                        quantity_text(o.median, o.scatter, o.unit),
                        fmt::format("{:+.1f}", o.deviations), o.last_contact_utc});
  if (outliers.size() > 1) out += "\n" + columns_text(outliers);
  return out;
}

std::string fleet_json(const Fleet& fleet) {
  using Json = nlohmann::ordered_json;
  Json norms = Json::array();
  for (const Norm& n : fleet.norms)
    norms.push_back({{"load", n.load.name},
                     {"moving_mass_kg", n.load.moving_mass_kg},
                     {"quantity", n.quantity},
                     {"unit", n.unit},
                     {"trucks", n.trucks},
                     {"median", n.median},
                     {"scatter", n.scatter}});
  Json outliers = Json::array();
  for (const Outlier& o : fleet.outliers)
    outliers.push_back({{"vehicle", o.vehicle},
                        {"truck", o.truck},
                        {"load", o.load.name},
                        {"moving_mass_kg", o.load.moving_mass_kg},
                        {"quantity", o.quantity},
                        {"unit", o.unit},
                        {"value", o.value.value},
                        {"std", o.value.std},
                        {"median", o.median},
                        {"scatter", o.scatter},
                        {"deviations", o.deviations},
                        {"last_contact_utc", o.last_contact_utc}});
  return json_text({{"schema", "dampline.fleet/1"},
                    {"cars", fleet.cars},
                    {"trucks", fleet.trucks},
                    {"segments", fleet.segments},
                    {"hours", fleet.hours},
                    {"last_contact_utc", fleet.last_contact_utc},
                    {"trucks_with_alarms", fleet.alarmed.all},
                    {"alarms", fleet.alarms},
                    {"trucks_silent", fleet.silent.all},
                    {"trucks_faulty", fleet.faulty.all},
                    {"files_refused", fleet.refused},
                    {"norms", norms},
                    {"outliers", outliers}});
}

}  // namespace dampline::app::fleet::page

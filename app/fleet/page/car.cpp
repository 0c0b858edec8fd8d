// SPDX-License-Identifier: MIT
// One car's history.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "app/compare/series.hpp"
#include "app/fleet/page/page.hpp"
#include "app/report/html.hpp"
#include "app/report/plots.hpp"
#include "app/report/svg/figure.hpp"
#include "app/run/provenance.hpp"
#include "app/text/format.hpp"

namespace dampline::app::fleet::page {
namespace {

using svg::Ink;

constexpr std::array kTruckInks{Ink::kBlue, Ink::kOrange, Ink::kGreen, Ink::kPink, Ink::kGrey};
constexpr std::int64_t kDayNs = 86'400'000'000'000;
constexpr std::size_t kMostSegments = 200;  // drawn of one truck and load; more are means of some

/// One figure of the trucks of a car with one load, over days.
struct Drawn {
  std::map<std::string, compare::Series> trucks;
  double largest{0.0};
};

/// Neighbours become their mean, so that years can be drawn: with the deviation that it has, or the
/// one by which they scatter where that is larger.
compare::Series thinned(const compare::Series& all) {
  const std::size_t stride = (all.points.size() + kMostSegments - 1) / kMostSegments;
  if (stride <= 1) return all;
  compare::Series out;
  for (std::size_t from = 0; from < all.points.size(); from += stride) {
    const std::size_t to = std::min(from + stride, all.points.size());
    double weights = 0.0;
    double sum = 0.0;
    double days = 0.0;
    for (std::size_t i = from; i < to; ++i) {
      const double w = 1.0 / (all.points[i].second.std * all.points[i].second.std);
      weights += w;
      sum += w * all.points[i].second.value;
      days += all.points[i].first / static_cast<double>(to - from);
    }
    Parameter mean = all.points[from].second;
    mean.value = sum / weights;
    double chi2 = 0.0;
    for (std::size_t i = from; i < to; ++i) {
      const double apart = (all.points[i].second.value - mean.value) / all.points[i].second.std;
      chi2 += apart * apart;
    }
    const double degrees = std::max(1.0, static_cast<double>(to - from) - 1.0);
    mean.std = std::sqrt(std::max(1.0, chi2 / degrees) / weights);
    out.points.emplace_back(days, mean);
  }
  return out;
}

Drawn drawn_of(const Car& car, const Load& load, std::int64_t midnight_ns, bool stiffness) {
  Drawn out;
  for (const CarSegment& s : car.segments) {
    const bool is_here = s.row.usable && s.row.load == load.name &&
                         s.row.moving_mass_kg == load.moving_mass_kg && s.row.start_ns != 0;
    if (!is_here || (stiffness && !s.row.stiffness_npm)) continue;
    const Estimate e = stiffness ? *s.row.stiffness_npm : s.row.coulomb_n;
    const double days = static_cast<double>(s.row.start_ns - midnight_ns) / double(kDayNs);
    out.trucks[s.truck].points.emplace_back(
        days,
        Parameter{stiffness ? "stiffness" : "coulomb", e.value, e.std, stiffness ? "N/m" : "N"});
    out.largest = std::max(out.largest, std::abs(e.value));
  }
  for (auto& [truck, series] : out.trucks) series = thinned(series);
  return out;
}

std::int64_t midnight_of(const Car& car) {
  std::int64_t first_ns = 0;
  for (const CarSegment& s : car.segments)
    if (s.row.start_ns != 0 && (first_ns == 0 || s.row.start_ns < first_ns))
      first_ns = s.row.start_ns;
  return first_ns - first_ns % kDayNs;
}

std::string load_section(const Car& car, const Load& load, std::size_t number) {
  const std::int64_t midnight_ns = midnight_of(car);
  constexpr std::size_t kToTheDay = 10;
  const std::string days =
      fmt::format("days since {}, 0 h UTC", utc_text(midnight_ns).substr(0, kToTheDay));
  Plot plot{{}, true};
  for (const bool stiffness : {false, true}) {
    const Drawn drawn = drawn_of(car, load, midnight_ns, stiffness);
    if (drawn.trucks.empty()) continue;
    const PlotUnit unit = plot_unit(stiffness ? "N/m" : "N", drawn.largest);
    svg::Panel panel{{days},
                     {fmt::format("{} ({})", stiffness ? "stiffness" : "level", unit.name)}};
    std::size_t i = 0;
    for (const auto& [truck, series] : drawn.trucks)
      compare::add_series(
          series, unit.factor, kTruckInks[i++ % kTruckInks.size()],
          truck.empty() ? (drawn.trucks.size() > 1 ? "no name" : "") : "truck " + truck, panel);
    plot.panels.push_back(std::move(panel));
  }
  if (plot.panels.empty()) return "";
  return fmt::format("<section><h2>Load: {}</h2>\n{}</section>\n", escape_html(load_text(load)),
                     figure(plot, fmt::format("history{}", number),
                            "Dots with bars and band: ± 2 standard deviations; of more than 200 "
                            "segments means of neighbours."));
}

/// The fleet's median beside a car's own figure.
std::string norm_text(const Car& car, const Load& load, const std::string& quantity) {
  for (const Norm& n : car.norms)
    if (n.load == load && n.quantity == quantity) return quantity_text(n.median, n.scatter, n.unit);
  return "";
}

std::string trend_table(const Car& car) {
  std::vector<std::vector<std::string>> rows;
  for (const CarTrend& of : car.trends) {
    const std::string& truck = of.truck;
    const Trend& t = of.trend;
    const Load load{t.load, t.moving_mass_kg};
    const auto add = [&](const char* quantity, const std::optional<Estimate>& value,
                         const char* unit) {
      if (value)
        rows.push_back({truck.empty() ? "(no name)" : truck, load_text(load), quantity,
                        estimate_text(value, unit), norm_text(car, load, quantity)});
    };
    add("level", t.level_n, "N");
    add("change", t.change_n, "N");
    add("trend", t.trend_n_per_year, "N/year");
    add("stiffness", t.stiffness_npm, "N/m");
  }
  if (rows.empty()) return "";
  return "<section><h2>Figures of the newest week</h2>\n" +
         html_table({"truck", "load", "what", "value", "median and scatter of the fleet"}, rows,
                    0) +
         "</section>\n";
}

std::string contact_table(const Car& car) {
  std::vector<std::vector<std::string>> rows;
  for (const TruckContact& t : car.trucks)
    rows.push_back({t.truck.empty() ? "(no name)" : t.truck, t.last_contact_utc,
                    format_count(static_cast<std::uint64_t>(t.segments)),
                    format_count(static_cast<std::uint64_t>(t.faulty_segments)),
                    fmt::format("{:.1f}", t.hours), plot_label(t.newest_trust),
                    plot_label(t.newest_alarms)});
  return html_table({"truck", "last contact (UTC)", "segments", "faulty", "hours", "newest segment",
                     "its alarms"},
                    rows, 0);
}

/// What somebody should know of a segment; empty: nothing.
std::string remark_on(const SegmentRow& row) {
  std::string out = plot_label(row.alarms);
  if (row.trust != "data_faulty") return out.empty() ? "" : "alarms: " + out;
  return "faults of the data spoil it" + (out.empty() ? "" : "; alarms: " + out);
}

std::string remark_table(const Car& car) {
  constexpr std::size_t kMost = 20;
  std::vector<std::vector<std::string>> rows;
  for (auto s = car.segments.rbegin(); s != car.segments.rend() && rows.size() < kMost; ++s)
    if (const std::string remark = remark_on(s->row); !remark.empty())
      rows.push_back({s->truck.empty() ? "(no name)" : s->truck, s->start_utc,
                      load_text({s->row.load, s->row.moving_mass_kg}),
                      fmt::format("{:.2f}", s->row.hours), remark});
  if (rows.empty()) return "";
  return fmt::format(
      "<section><h2>Segments with alarms or faults of the data</h2>\n{}"
      "<p class=\"note\">The newest {} of them at most.</p></section>\n",
      html_table({"truck", "start (UTC)", "load", "hours", "what"}, rows, 0), kMost);
}

}  // namespace

std::string car_page(const Car& car, const std::string& where, Kind kind) {
  std::string body = contact_table(car);
  if (!car.outliers.empty())
    body += "<section><h2>Outside of its fleet</h2>\n" + outlier_table(car.outliers, kind) +
            "</section>\n";
  std::vector<Load> loads;
  for (const CarTrend& t : car.trends)
    if (const Load load{t.trend.load, t.trend.moving_mass_kg};
        std::find(loads.begin(), loads.end(), load) == loads.end())
      loads.push_back(load);
  for (std::size_t i = 0; i < loads.size(); ++i) body += load_section(car, loads[i], i + 1);
  body += trend_table(car);
  body += remark_table(car);
  if (kind == Kind::kServed) {
    const std::string query = car_link(car.vehicle, kind).substr(std::string{"/car"}.size());
    body += fmt::format(
        "<p class=\"note\">Tables (CSV): <a href=\"/segment.csv{0}\">segments</a>, "
        "<a href=\"/month.csv{0}\">months</a></p>\n",
        escape_html(query));
  }
  body += fmt::format("<p class=\"note\">From {}.</p>\n", escape_html(where));
  return framed("car " + vehicle_text(car.vehicle), body, kind);
}

}  // namespace dampline::app::fleet::page

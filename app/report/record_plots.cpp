// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "app/report/html.hpp"
#include "app/report/plots.hpp"
#include "app/report/sections.hpp"
#include "app/text/format.hpp"
#include "app/text/summary.hpp"

namespace dampline::app {
namespace {

using svg::Box;
using svg::Ink;
using svg::kLaneHalf;
using svg::Point;

constexpr const char* kTime = "time in the record (s)";

/// One column of a table over another, thinned to what can be seen.
template <class Row>
std::vector<Point> column(const std::vector<Row>& rows, double Row::*x, double x_factor,
                          double Row::*y, double y_factor) {
  std::vector<Point> out;
  for (std::size_t i = 0; i < rows.size(); i += plot_stride(rows.size()))
    out.push_back({x_factor * rows[i].*x, y_factor * rows[i].*y});
  return out;
}

}  // namespace

Plot plot_motion(const RunResult& result) {
  if (result.motion.size() < 2) return {};
  constexpr double kLow = 150.0;
  const auto over_time = [&](double MotionRow::*of) {
    return column(result.motion, &MotionRow::time_s, 1.0, of, 1e3);
  };
  svg::Panel deflection{{kTime}, {"y (mm)"}, kLow};
  deflection.line(over_time(&MotionRow::deflection_m), {Ink::kBlue, 1.0}, "relative deflection y");
  svg::Panel velocity{{kTime}, {"v (mm/s)"}, kLow};
  velocity.line(over_time(&MotionRow::velocity_mps), {Ink::kOrange, 1.0}, "relative velocity v");
  return {{deflection, velocity}};
}

Plot plot_force(const RunResult& result) {
  if (result.force.size() < 2) return {};
  constexpr double kDot = 0.8;
  svg::Panel time{{kTime}, {"force (N)"}};
  svg::Panel velocity{{"velocity (mm/s)"}, {"force (N)"}};
  for (const auto& [of, ink, name] : {std::tuple{&ForceRow::measured_n, Ink::kBlue, "measured"},
                                      std::tuple{&ForceRow::fitted_n, Ink::kOrange, "fitted"}}) {
    time.line(column(result.force, &ForceRow::time_s, 1.0, of, 1.0), {ink, 1.4}, name);
    velocity.dots(column(result.force, &ForceRow::velocity_mps, 1e3, of, 1.0), ink, kDot, name);
  }
  return {{time, velocity}};
}

Plot plot_excluded(const RunResult& result) {
  if (result.excluded.empty()) return {};
  std::map<std::string, std::size_t> row_of;
  std::vector<svg::Lane> lanes;
  std::vector<Box> spans;
  for (const Excluded& e : result.excluded) {
    const auto [place, is_new] = row_of.emplace(e.reason, lanes.size());
    if (is_new) lanes.push_back({plot_label(e.reason), ""});
    const auto row = static_cast<double>(place->second);
    spans.push_back({e.start_s, e.end_s, row - kLaneHalf, row + kLaneHalf});
  }
  svg::Panel panel{{kTime, 0.0, std::max(result.duration_s, result.excluded.back().end_s)},
                   std::move(lanes)};
  panel.boxes(spans, Ink::kOrange, 0.9);
  return {{panel}};
}

namespace {

struct Moments {
  double mean{0.0};
  double std{0.0};
};

Moments moments_of(const DensityTable& table) {
  double sum = 0.0;
  double first = 0.0;
  double second = 0.0;
  for (const DensityRow& r : table.rows) {
    sum += r.density;
    first += r.density * r.centre;
    second += r.density * r.centre * r.centre;
  }
  if (!(sum > 0.0)) return {};
  const double mean = first / sum;
  return {mean, std::sqrt(std::max(0.0, second / sum - mean * mean))};
}

bool is_velocity(const DensityTable& table) { return table.quantity == "velocity_mps"; }

/// In mm and mm/s, beside the normal density of the same moments.
svg::Panel density_panel(const DensityTable& table) {
  const bool velocity = is_velocity(table);
  const Moments m = moments_of(table);
  std::vector<Box> bars;
  std::vector<Point> normal;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const DensityRow& r = table.rows[i];
    const double next = i + 1 < table.rows.size() ? table.rows[i + 1].centre - r.centre
                        : i > 0                   ? r.centre - table.rows[i - 1].centre
                                                  : 0.0;
    bars.push_back(
        {1e3 * (r.centre - 0.5 * next), 1e3 * (r.centre + 0.5 * next), 0.0, 1e-3 * r.density});
    const double z = (r.centre - m.mean) / m.std;
    normal.push_back({1e3 * r.centre,
                      1e-3 * std::exp(-0.5 * z * z) / (m.std * std::sqrt(2.0 * std::numbers::pi))});
  }
  svg::Panel panel{{velocity ? "relative velocity v (mm/s)" : "relative deflection y (mm)"},
                   {velocity ? "density (s/mm)" : "density (1/mm)", 0.0}};
  panel.boxes(bars, velocity ? Ink::kOrange : Ink::kBlue);
  if (m.std > 0.0) panel.line(std::move(normal), {Ink::kGrey, 1.4}, "normal");
  return panel;
}

}  // namespace

Plot plot_densities(const RunResult& result) {
  Plot plot{{}, true};
  for (const DensityTable& table : result.densities) plot.panels.push_back(density_panel(table));
  return plot;
}

namespace {

svg::Panel convergence_panel(const Convergence& convergence, std::size_t i) {
  constexpr double kLow = 150.0;
  const Estimate& end = convergence.rows.back().estimates[i];
  const PlotUnit unit = plot_unit(convergence.units[i], std::fabs(end.value));
  std::vector<Point> middle;
  std::vector<Point> lower;
  std::vector<Point> upper;
  std::vector<double> deviations;
  for (const Convergence::Row& row : convergence.rows) {
    const Estimate& e = row.estimates[i];
    middle.push_back({row.time_s, unit.factor * e.value});
    lower.push_back({row.time_s, unit.factor * (e.value - 2.0 * e.std)});
    upper.push_back({row.time_s, unit.factor * (e.value + 2.0 * e.std)});
    deviations.push_back(std::isfinite(e.std) ? e.std : 0.0);
  }
  // The first rows may be wild: show what lies within a few of the median deviation.
  const auto median = deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() / 2);
  std::nth_element(deviations.begin(), median, deviations.end());
  const double half =
      unit.factor * std::max({8.0 * *median, 10.0 * end.std, 0.005 * std::fabs(end.value)});
  const double centre = unit.factor * end.value;
  svg::Axis y{fmt::format("{} ({})", plot_label(convergence.names[i]), unit.name)};
  if (half > 0.0) y.low = centre - half;
  if (half > 0.0) y.high = centre + half;
  svg::Panel panel{{kTime, 0.0}, std::move(y), kLow};
  panel.band(lower, upper, Ink::kBlue, "± 2 standard deviations");
  panel.line({{0.0, centre}, {convergence.rows.back().time_s, centre}}, {Ink::kGrey, 1.2, true},
             "at the end");
  panel.line(std::move(middle), {Ink::kBlue, 2.0}, plot_label(convergence.names[i]));
  return panel;
}

}  // namespace

Plot plot_convergence(const RunResult& result) {
  const Convergence& convergence = result.convergence;
  Plot plot;
  if (convergence.rows.size() < 2) return plot;
  for (std::size_t i = 0; i < convergence.names.size(); ++i)
    plot.panels.push_back(convergence_panel(convergence, i));
  return plot;
}

Plot plot_events(const RunResult& result) {
  if (result.events.empty()) return {};
  constexpr std::size_t kMostTicks = 4000;  // per kind; more would be one black bar all the same
  std::map<std::string, std::vector<double>> times;
  for (const RunEvent& e : result.events) times[e.name].push_back(e.time_s);
  std::vector<svg::Lane> lanes;
  std::vector<Box> ticks;
  for (const auto& [name, moments] : times) {
    const auto row = static_cast<double>(lanes.size());
    const std::size_t stride = (moments.size() + kMostTicks - 1) / kMostTicks;
    for (std::size_t i = 0; i < moments.size(); i += stride)
      ticks.push_back({moments[i], moments[i], row - kLaneHalf, row + kLaneHalf});
    lanes.push_back({plot_label(name), format_count(moments.size())});
  }
  const double first = std::min(0.0, result.events.front().time_s);
  const double last = std::max(result.duration_s, result.events.back().time_s);
  const double margin = 0.01 * (last - first);
  svg::Panel panel{{kTime, first - margin, last + margin}, std::move(lanes)};
  panel.boxes(ticks, Ink::kBlue, 1.0);
  return {{panel}};
}

Plot plot_lateness(const RunResult& result) {
  if (result.lateness.empty() || !result.live) return {};
  constexpr double kLeastUs = 1e-3;  // a nanosecond: a logarithmic axis has no 0
  constexpr double kBelowOne = 0.5;
  std::uint64_t most = 0;
  std::vector<Box> bars;
  for (const LatenessRow& r : result.lateness) {
    most = std::max(most, r.frames);
    bars.push_back({std::max(r.from_us, kLeastUs), std::max(r.to_us, kLeastUs), kBelowOne,
                    static_cast<double>(r.frames)});
  }
  // Decades of frames above the highest bar, where the names stand, one below the other.
  svg::Panel panel{{"from a frame's stamp to its result (µs)", 0.8 * bars.front().left,
                    8.0 * bars.back().right, true},
                   {"frames", kBelowOne, 2.0 * std::pow(static_cast<double>(most), 1.6), true}};
  panel.boxes(bars, Ink::kBlue);
  const LiveFigures& f = *result.live;
  double height = 0.97;
  for (const auto& [name, us] :
       {std::pair{"p50", f.lateness_p50_us}, std::pair{"p90", f.lateness_p90_us},
        std::pair{"p99", f.lateness_p99_us}, std::pair{"p99.9", f.lateness_p999_us},
        std::pair{"largest", f.lateness_max_us}}) {
    panel.flag(std::max(us, kLeastUs), height, fmt::format("{} {}", name, format_microseconds(us)));
    height -= 0.085;
  }
  return {{panel}};
}

namespace {

std::string label_of(const FaultFinding& fault) {
  return plot_label(fault.name) + ", " + fault.channel;
}

std::size_t rank_of(const std::string& channel) {
  constexpr std::array<std::string_view, 5> kOrder{"frame", "wheelset1", "wheelset2", "wheelsets",
                                                   "all"};
  return static_cast<std::size_t>(std::find(kOrder.begin(), kOrder.end(), channel) -
                                  kOrder.begin());
}

}  // namespace

/// Channel by channel; below them what was left out of the estimate.
Plot plot_faults(const RunResult& result) {
  if (result.faults.list.empty()) return {};
  std::vector<const FaultFinding*> sorted;
  for (const FaultFinding& f : result.faults.list) sorted.push_back(&f);
  std::stable_sort(sorted.begin(), sorted.end(), [](const FaultFinding* a, const FaultFinding* b) {
    return rank_of(a->channel) < rank_of(b->channel);
  });
  std::vector<svg::Lane> lanes;
  std::vector<Box> spoilt;
  std::vector<Box> left_out;
  std::vector<Point> seen;
  const auto box = [](double from, double to, std::size_t row) {
    const auto y = static_cast<double>(row);
    return Box{from, to, y - kLaneHalf, y + kLaneHalf};
  };
  for (const FaultFinding* f : sorted) {
    const std::size_t row = lanes.size();
    for (const Span& s : f->spans) spoilt.push_back(box(s.start_s, s.end_s, row));
    const auto y = static_cast<double>(row);
    seen.insert(seen.end(), {{f->time_s, y}, {f->last_s, y}, svg::kBreak});
    lanes.push_back({label_of(*f), fault_size(*f)});
  }
  std::map<std::string, std::size_t> lane;
  for (const Excluded& e : result.excluded) {
    const auto [place, is_new] = lane.emplace(e.reason, lanes.size());
    if (is_new) lanes.push_back({"left out: " + plot_label(e.reason), ""});
    left_out.push_back(box(e.start_s, e.end_s, place->second));
  }
  svg::Panel panel{{kTime, 0.0, std::max(result.duration_s, 1.0)}, std::move(lanes)};
  panel.boxes(spoilt, Ink::kOrange, 0.7, spoilt.empty() ? "" : "spoilt");
  panel.boxes(left_out, Ink::kGrey, 0.7, left_out.empty() ? "" : "left out");
  panel.dots(seen, Ink::kBlue, 3.0);
  panel.line(std::move(seen), {Ink::kBlue, 2.0}, "from first to last seen");
  return {{panel}};
}

}  // namespace dampline::app

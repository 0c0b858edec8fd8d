// SPDX-License-Identifier: MIT
#include "app/fleet/trend.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace dampline::app::fleet {
namespace {

constexpr double kYearNs = 365.25 * 24.0 * 3600.0 * 1e9;
/// From what a line's scatter is known: three degrees of freedom.
constexpr std::size_t kLeastForLine = 5;

/// A segment's level at its middle, in years before the newest one's end.
struct LevelPoint {
  double years{0.0};
  double value{0.0};
  double std{0.0};
};

double weight(double std) { return 1.0 / (std * std); }

/// Weighted by their deviations; nothing of nothing.
std::optional<Estimate> mean_of(std::span<const LevelPoint> points) {
  double weights = 0.0;
  double sum = 0.0;
  for (const LevelPoint& p : points) {
    weights += weight(p.std);
    sum += weight(p.std) * p.value;
  }
  if (points.empty()) return std::nullopt;
  return Estimate{sum / weights, std::sqrt(1.0 / weights)};
}

/// How far the points are from a line, in their deviations, beyond what `parameters` took up.
double scatter_of(std::span<const LevelPoint> points, double parameters, const auto& line) {
  double chi2 = 0.0;
  for (const LevelPoint& p : points)
    chi2 += weight(p.std) * (p.value - line(p.years)) * (p.value - line(p.years));
  return std::sqrt(chi2 / (static_cast<double>(points.size()) - parameters));
}

struct Line {
  Estimate slope;
  double scatter{0.0};
};

std::optional<Line> line_of(std::span<const LevelPoint> points) {
  if (points.size() < kLeastForLine) return std::nullopt;
  double weights = 0.0;
  double years = 0.0;
  for (const LevelPoint& p : points) {
    weights += weight(p.std);
    years += weight(p.std) * p.years;
  }
  years /= weights;
  const double level = mean_of(points)->value;
  double spread = 0.0;
  double together = 0.0;
  for (const LevelPoint& p : points) {
    spread += weight(p.std) * (p.years - years) * (p.years - years);
    together += weight(p.std) * (p.years - years) * (p.value - level);
  }
  if (!(spread > 0.0)) return std::nullopt;
  const double slope = together / spread;
  const double scatter =
      scatter_of(points, 2.0, [&](double at) { return level + slope * (at - years); });
  return Line{{slope, std::sqrt(1.0 / spread)}, scatter};
}

/// What the segments scatter beyond their deviations is in the deviation of what is made of them.
std::optional<Estimate> widened(std::optional<Estimate> estimate, double scatter) {
  if (estimate) estimate->std *= std::max(1.0, scatter);
  return estimate;
}

void fill_levels(std::span<const SegmentRow* const> rows, Trend& out) {
  std::vector<LevelPoint> all;
  std::vector<LevelPoint> year;
  std::vector<LevelPoint> before;
  std::vector<LevelPoint> newest;
  std::vector<LevelPoint> stiffness;
  std::int64_t end_ns = 0;
  for (const SegmentRow* row : rows) end_ns = std::max(end_ns, row->end_ns);
  for (const SegmentRow* row : rows) {
    const double ago_ns = 0.5 * (static_cast<double>(end_ns - row->start_ns) +
                                 static_cast<double>(end_ns - row->end_ns));
    const LevelPoint point{-ago_ns / kYearNs, row->coulomb_n.value, row->coulomb_n.std};
    all.push_back(point);
    if (row->start_ns == 0 || ago_ns > kYearNs) continue;
    const bool is_new = ago_ns <= static_cast<double>(kNewestNs);
    year.push_back(point);
    (is_new ? newest : before).push_back(point);
    if (is_new && row->stiffness_npm)
      stiffness.push_back({point.years, row->stiffness_npm->value, row->stiffness_npm->std});
  }
  const std::optional<Line> line = line_of(year);
  const double scatter = line ? line->scatter : 1.0;
  const auto mean = mean_of(all);
  if (mean && all.size() > 1) {
    const double about = scatter_of(all, 1.0, [&](double) { return mean->value; });
    out.mean_n = widened(mean, about);
  } else {
    out.mean_n = mean;
  }
  out.level_n = newest.empty() ? out.mean_n : widened(mean_of(newest), scatter);
  out.stiffness_npm = widened(mean_of(stiffness), scatter);
  if (!line) return;
  out.scatter = scatter;
  out.trend_n_per_year = widened(line->slope, scatter);
  if (const auto then = widened(mean_of(before), scatter); then && !newest.empty())
    out.change_n =
        Estimate{out.level_n->value - then->value, std::hypot(out.level_n->std, then->std)};
}

Trend trend_of(std::span<const SegmentRow* const> rows) {
  Trend out;
  out.load = rows.front()->load;
  out.moving_mass_kg = rows.front()->moving_mass_kg;
  out.first_ns = rows.front()->start_ns;
  std::vector<const SegmentRow*> usable;
  for (const SegmentRow* row : rows) {
    ++out.segments;
    if (row->trust == "data_faulty") ++out.faulty_segments;
    out.hours += row->hours;
    if (row->end_ns >= out.last_ns) {
      out.last_ns = row->end_ns;
      out.newest_trust = row->trust;
      out.newest_alarms = row->alarms;
    }
    if (row->usable) usable.push_back(row);
  }
  out.usable_segments = static_cast<std::int64_t>(usable.size());
  fill_levels(usable, out);
  return out;
}

}  // namespace

std::vector<Trend> trends_of(std::span<const SegmentRow> rows) {
  std::map<std::pair<std::string, double>, std::vector<const SegmentRow*>> loads;
  for (const SegmentRow& row : rows) loads[{row.load, row.moving_mass_kg}].push_back(&row);
  std::vector<Trend> out;
  out.reserve(loads.size());
  for (const auto& [load, list] : loads) out.push_back(trend_of(list));
  return out;
}

}  // namespace dampline::app::fleet

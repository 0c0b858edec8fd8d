// SPDX-License-Identifier: MIT
#include "app/compare/series.hpp"

namespace dampline::app::compare {

void add_series(const Series& series, double factor, svg::Ink ink, const std::string& name,
                svg::Panel& panel) {
  constexpr double kBandStds = 2.0;
  std::vector<svg::Point> middle;
  std::vector<svg::Point> lower;
  std::vector<svg::Point> upper;
  std::vector<svg::Point> bars;
  for (const auto& [x, p] : series.points) {
    const double half = kBandStds * p.std;
    middle.push_back({x, factor * p.value});
    lower.push_back({x, factor * (p.value - half)});
    upper.push_back({x, factor * (p.value + half)});
    bars.insert(bars.end(), {lower.back(), upper.back(), svg::kBreak});
  }
  if (middle.size() > 1) panel.band(lower, upper, ink);
  panel.line(std::move(bars), {ink, 1.5});
  if (middle.size() > 1) panel.line(middle, {ink, 1.0, true});
  panel.dots(std::move(middle), ink, 4.0, name);
}

}  // namespace dampline::app::compare

// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "app/report/html.hpp"
#include "app/report/plots.hpp"
#include "app/report/sections.hpp"
#include "app/text/format.hpp"
#include "app/text/summary.hpp"

namespace dampline::app {
namespace {

using svg::Ink;
using svg::Point;

std::string short_number(double value, const char* unit = "") {
  return std::isfinite(value) ? fmt::format("{:.3g}{}", value, unit) : std::string{"–"};
}

/// Term i of the model, as it was asked for.
const std::string& term_name(const RunResult& result, std::size_t i) {
  return i < result.model.size() ? result.model[i] : result.parameters[i].name;
}

}  // namespace

std::string term_section(const RunResult& result) {
  if (!result.row_method) return "";
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    const Parameter& p = result.parameters[i];
    const QuantityText text = format_quantity(p.value, p.std);
    rows.push_back({term_name(result, i), text.value, text.std.empty() ? "" : "± " + text.std,
                    p.unit, short_number(p.value / p.std), short_number(p.cov)});
  }
  std::string out =
      html_table({"term", "estimate", "standard deviation", "unit", "t", "COV"}, rows, 5);
  const RowMethod& m = *result.row_method;
  rows.clear();
  for (std::size_t d = 0; d < m.mse_percent.size(); ++d)
    rows.push_back({m.mse_percent.size() == 1 ? "MSE" : fmt::format("MSE of mass {}", d + 1),
                    short_number(m.mse_percent[d], " %"),
                    short_number(m.held_out_mse_percent[d], " %")});
  return out + html_table({"", "fitted", "held out"}, rows, 2) +
         fmt::format("<p class=\"note\">{}.</p>\n", escape_html(describe_rows(result)));
}

std::string term_set_section(const RunResult& result) {
  if (result.term_sets.empty()) return "";
  std::vector<std::vector<std::string>> rows;
  for (const TermSet& s : result.term_sets)
    rows.push_back({s.change, short_number(s.t), short_number(s.mse_percent, " %"),
                    short_number(s.held_out_mse_percent, " %")});
  return html_table({"set of terms", "t of that term", "MSE, fitted", "MSE, held out"}, rows, 3);
}

Plot plot_windows(const RunResult& result) {
  constexpr double kHigh = 150.0;
  constexpr double kDot = 2.0;
  constexpr double kShown = 6.0;  // scatters of the windows
  Plot plot;
  const Convergence& windows = result.windows;
  for (std::size_t i = 0; i < windows.names.size() && i < result.parameters.size(); ++i) {
    const Parameter& p = result.parameters[i];
    std::vector<Point> dots;
    std::vector<Point> bars;
    for (const Convergence::Row& row : windows.rows) {
      const Estimate& e = row.estimates[i];
      dots.push_back({row.time_s, e.value});
      bars.push_back({row.time_s, e.value - 2.0 * e.std});
      bars.push_back({row.time_s, e.value + 2.0 * e.std});
      bars.push_back(svg::kBreak);
    }
    svg::Axis y{fmt::format("{} ({})", plot_label(windows.names[i]), windows.units[i])};
    const double half = kShown * p.cov * std::abs(p.value);
    if (std::isfinite(half) && half > 0.0) {
      y.low = p.value - half;
      y.high = p.value + half;
    }
    svg::Panel panel{{"time (s)", 0.0}, std::move(y), kHigh};
    panel.line(std::move(bars), {Ink::kGrey, 1.0});
    panel.line({{0.0, p.value}, {windows.rows.back().time_s, p.value}}, {Ink::kOrange, 1.4, true},
               "mean");
    panel.dots(std::move(dots), Ink::kBlue, kDot, "window");
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

Plot plot_cov(const RunResult& result) {
  if (result.cov.size() < 2) return {};
  constexpr std::array kInks{Ink::kBlue, Ink::kOrange, Ink::kGreen, Ink::kPink, Ink::kGrey};
  svg::Panel panel{{"time (s)", 0.0}, {"COV", std::nullopt, std::nullopt, true}};
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    std::vector<Point> line;
    for (const CovRow& row : result.cov)
      line.push_back(i < row.cov.size() && row.cov[i] > 0.0 ? Point{row.time_s, row.cov[i]}
                                                            : svg::kBreak);
    panel.line(std::move(line), {kInks[i % kInks.size()], 1.8, i >= kInks.size()},
               term_name(result, i));
  }
  return {{std::move(panel)}};
}

Plot plot_term_sets(const RunResult& result) {
  constexpr double kShift = 0.22;
  std::vector<svg::Lane> lanes;
  std::vector<svg::Box> fitted;
  std::vector<svg::Box> held_out;
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  for (const TermSet& s : result.term_sets) {
    if (!std::isfinite(s.held_out_mse_percent) || !(s.mse_percent > 0.0)) continue;
    low = std::min(low, s.mse_percent);
    high = std::max(high, s.held_out_mse_percent);
  }
  if (!(high > 0.0)) return {};
  const double left = 0.5 * low;
  for (const TermSet& s : result.term_sets) {
    if (!std::isfinite(s.held_out_mse_percent)) continue;
    const auto row = static_cast<double>(lanes.size());
    const std::string name = s.change.substr(0, s.change.find(':'));
    lanes.push_back({name, short_number(s.held_out_mse_percent, " %")});
    fitted.push_back({left, s.mse_percent, row - kShift, row});
    held_out.push_back({left, s.held_out_mse_percent, row, row + kShift});
  }
  svg::Panel panel{{"MSE (%)", left, 2.0 * high, true}, std::move(lanes)};
  panel.boxes(fitted, Ink::kGrey, 0.9, "fitted");
  panel.boxes(held_out, Ink::kBlue, 0.9, "held out");
  return {{std::move(panel)}};
}

}  // namespace dampline::app

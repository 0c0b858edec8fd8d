// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/report/plot_style.hpp"
#include "app/report/plots.hpp"

namespace dampline::app {
namespace {

std::string convergence_panel(const Convergence& convergence, std::size_t i, double top,
                              double bottom, bool last) {
  const auto& rows = convergence.rows;
  const PlotUnit unit = plot_unit(convergence.units[i], std::fabs(rows.back().estimates[i].value));
  const double scale = unit.factor;
  std::string out = fmt::format("$p{} << EOD\n", i);
  for (const Convergence::Row& row : convergence.rows)
    out += fmt::format("{} {} {}\n", row.time_s, scale * row.estimates[i].value,
                       scale * row.estimates[i].std);
  const Estimate& final_estimate = convergence.rows.back().estimates[i];
  // The first rows may be wild: show what lies within a few of the median deviation.
  std::vector<double> deviations;
  for (const Convergence::Row& row : convergence.rows) deviations.push_back(row.estimates[i].std);
  std::nth_element(deviations.begin(),
                   deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() / 2),
                   deviations.end());
  const double half =
      scale * std::max({8.0 * deviations[deviations.size() / 2], 10.0 * final_estimate.std,
                        0.005 * std::fabs(final_estimate.value)});
  const double centre = scale * final_estimate.value;
  out += fmt::format("EOD\nset tmargin at screen {}\nset bmargin at screen {}\n", top, bottom);
  if (half > 0.0) out += fmt::format("set yrange [{}:{}]\n", centre - half, centre + half);
  out += last ? "set xlabel 'time in the record (s)'\nset format x '%g'\n"
              : "unset xlabel\nset format x ''\n";
  out += fmt::format(
      "set ylabel '{0} ({1})'\nplot $p{2} using 1:($2-2*$3):($2+2*$3) with filledcurves lc rgb "
      "'{3}' "
      "title '± 2 standard deviations', '' using 1:2 with lines lw 2 lc rgb '{3}' title '{0}', {4} "
      "with lines dt 2 lw 1 lc rgb '#777777' title 'at the end'\n",
      plot_label(convergence.names[i]), unit.name, i, kPlotBlue, centre);
  return out;
}

}  // namespace

PlotScript plot_convergence(const RunResult& result) {
  const Convergence& convergence = result.convergence;
  if (convergence.rows.size() < 2 || convergence.names.empty()) return {};
  const auto panels = static_cast<double>(convergence.names.size());
  const int height = 90 + 210 * static_cast<int>(convergence.names.size());
  const double bottom = 62.0 / height;
  const double step = (0.999 - bottom) / panels;
  std::string script =
      fmt::format("{}{}{}", kPlotFrame, kPlotKeyAbove, "set multiplot\nset xrange [0:*]\n");
  for (std::size_t i = 0; i < convergence.names.size(); ++i) {
    const double top = 0.999 - 26.0 / height - step * static_cast<double>(i);
    script += convergence_panel(convergence, i, top, top - step + 36.0 / height,
                                i + 1 == convergence.names.size());
  }
  return {script + "unset multiplot\n", 960, height};
}

}  // namespace dampline::app

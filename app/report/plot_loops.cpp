// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "app/report/evidence.hpp"
#include "app/report/plot_style.hpp"

namespace dampline::app {
namespace {

constexpr double kRoom = 1.05;

/// Force over one column of $loops; the data wide and grey behind the two models.
std::string panel(int column, const char* label, double left, double right, double bottom,
                  double top, int model, const char* title) {
  const std::string_view colour = model == 5 ? kPlotBlue : kPlotOrange;
  return fmt::format(
      "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\n"
      "set tmargin at screen {}\nset xlabel '{}'\n"
      "plot $loops using {}:3 with lines lw 3 lc rgb '#bbbbbb' title 'measured', "
      "'' using {}:{} with lines lw 1 lc rgb '{}' title '{}'\n",
      left, right, bottom, top, label, column, column, model, colour, title);
}

}  // namespace

PlotScript plot_loops(const Evidence& evidence) {
  if (evidence.loops.size() < 2) return {};
  double largest = 0.0;
  double bottom = 0.0;
  double top = 0.0;
  for (const LoopRow& r : evidence.loops) {
    largest = std::max(largest, std::fabs(r.measured_n));
    bottom = std::min({bottom, kRoom * r.measured_n, kRoom * r.base_n, kRoom * r.final_n});
    top = std::max({top, kRoom * r.measured_n, kRoom * r.base_n, kRoom * r.final_n});
  }
  const PlotUnit unit = plot_unit("N", largest);
  std::string script = fmt::format("{}{}$loops << EOD\n", kPlotFrame, kPlotKeyAbove);
  for (const LoopRow& r : evidence.loops)
    fmt::format_to(std::back_inserter(script), "{} {} {} {} {}\n", 1e3 * r.deflection_m,
                   1e3 * r.velocity_mps, unit.factor * r.measured_n, unit.factor * r.base_n,
                   unit.factor * r.final_n);
  script +=
      fmt::format("EOD\nset multiplot\nset ylabel 'force ({})' offset 1\nset yrange [{}:{}]\n",
                  unit.name, unit.factor * bottom, unit.factor * top);
  script += panel(2, "velocity v (mm/s)", 0.095, 0.485, 0.60, 0.95, 4, "before");
  script += panel(2, "velocity v (mm/s)", 0.595, 0.985, 0.60, 0.95, 5, "after");
  script += panel(1, "deflection y (mm)", 0.095, 0.485, 0.09, 0.44, 4, "before");
  script += panel(1, "deflection y (mm)", 0.595, 0.985, 0.09, 0.44, 5, "after");
  return {script + "unset multiplot\n", 960, 760};
}

}  // namespace dampline::app

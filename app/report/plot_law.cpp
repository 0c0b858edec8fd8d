// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/evidence.hpp"
#include "app/report/plot_style.hpp"

namespace dampline::app {

PlotScript plot_law(const Evidence& evidence) {
  if (evidence.law.size() < 2) return {};
  double largest = 0.0;
  for (const LawRow& r : evidence.law) largest = std::max(largest, std::fabs(r.final_n));
  const PlotUnit unit = plot_unit("N", largest);
  std::string script = fmt::format("{}{}$law << EOD\n", kPlotFrame, kPlotKeyAbove);
  double last = evidence.law.front().velocity_mps;
  for (const LawRow& r : evidence.law) {
    if (last < 0.0 && r.velocity_mps > 0.0) script += "\n";  // nothing joins the branches
    last = r.velocity_mps;
    script += fmt::format("{} {} {}\n", 1e3 * r.velocity_mps, unit.factor * r.base_n,
                          unit.factor * r.final_n);
  }
  script += fmt::format(
      "EOD\nset tmargin 2\nset xlabel 'velocity v (mm/s)'\nset ylabel 'damping force F ({})' "
      "offset 0.5\n"
      "plot $law using 1:2 with lines lw 2 lc rgb '{}' title 'before', "
      "'' using 1:3 with lines lw 2.4 lc rgb '{}' title 'after'\n",
      unit.name, kPlotOrange, kPlotBlue);
  return {script, 960, 380};
}

}  // namespace dampline::app

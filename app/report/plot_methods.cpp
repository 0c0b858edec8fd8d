// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/plot_style.hpp"
#include "app/report/plots.hpp"

namespace dampline::app {
namespace {

constexpr std::string_view kGreyLine = "dt 2 lw 1.6 lc rgb '#999999'";
constexpr std::array<std::string_view, 3> kTrusted{"lw 2 lc rgb '#d55e00'", "lw 2 lc rgb '#009e73'",
                                                   "lw 2 lc rgb '#cc79a7'"};

double side_of(double velocity_mps) { return velocity_mps < 0.0 ? -1.0 : 1.0; }

/// Columns: v in mm/s, then F sign v and its deviation for the windows and for each method.
std::string method_data(const RunResult& result, double factor) {
  std::string data = "$methods << EOD\n";
  for (std::size_t i = 0; i < result.curve.size(); ++i) {
    const CurveRow& r = result.curve[i];
    if (r.velocity_mps == 0.0) {
      data += "\n";  // nothing joins the branches
      continue;
    }
    const double sign = factor * side_of(r.velocity_mps);
    data += fmt::format("{} {} {}", 1e3 * r.velocity_mps, sign * r.force_n, factor * r.std_n);
    for (const MethodSummary& m : result.methods)
      data += fmt::format(" {} {}", sign * m.curve_n.at(i).value, factor * m.curve_n.at(i).std);
    data += "\n";
  }
  return data + "EOD\n";
}

}  // namespace

PlotScript plot_methods(const RunResult& result) {
  if (result.methods.empty() || result.curve.empty()) return {};
  double largest = 0.0;
  for (const CurveRow& r : result.curve) largest = std::max(largest, std::fabs(r.force_n));
  const PlotUnit unit = plot_unit("N", largest);
  std::string script = fmt::format("{}{}", kPlotFrame, method_data(result, unit.factor));
  script += fmt::format(
      "set key outside bottom center horizontal maxrows 3 noopaque\n"
      "set xlabel 'relative velocity v (mm/s)'\nset ylabel 'F sign v ({})' offset 0.5\n"
      "set yrange [0:*]\n"
      "plot $methods using 1:($2-2*$3):($2+2*$3) with filledcurves lc rgb '{}' notitle, "
      "'' using 1:2 with lines lw 2.4 lc rgb '{}' title 'wavelet windows'",
      unit.name, kPlotBlue, kPlotBlue);
  std::size_t colour = 0;
  for (std::size_t m = 0; m < result.methods.size(); ++m) {
    const MethodSummary& method = result.methods[m];
    if (!method.has_level) continue;
    const std::string_view line = method.trusted ? kTrusted[colour++ % kTrusted.size()] : kGreyLine;
    script +=
        fmt::format(", '' using 1:{} with linespoints pt {} ps 0.5 {} title '{}{}'", 4 + 2 * m,
                    4 + 2 * m, line, method.title, method.trusted ? "" : " (not to be trusted)");
  }
  return {script + "\n", 960, 460};
}

}  // namespace dampline::app

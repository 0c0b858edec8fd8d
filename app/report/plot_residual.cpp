// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

#include "app/report/evidence.hpp"
#include "app/report/plot_style.hpp"

namespace dampline::app {
namespace {

struct Panel {
  std::string_view over;
  std::string_view label;
  double factor;
  bool mean;  // beside the rms
  double left, right, bottom, top;
};

constexpr std::array kPanels{
    Panel{"deflection_m", "deflection y (mm)", 1e3, true, 0.1, 0.49, 0.60, 0.93},
    Panel{"velocity_mps", "velocity v (mm/s)", 1e3, true, 0.6, 0.985, 0.60, 0.93},
    Panel{"frequency_hz", "frequency (Hz)", 1.0, false, 0.1, 0.49, 0.12, 0.45},
    Panel{"time_s", "time in the record (s)", 1.0, false, 0.6, 0.985, 0.12, 0.45}};

/// Columns: place, rms before, rms after, mean before, mean after.
std::string data_of(const Evidence& evidence, const Panel& panel, double factor) {
  std::string data;
  for (const ResidualRow& r : evidence.residual)
    if (r.over == panel.over)
      fmt::format_to(std::back_inserter(data), "{} {} {} {} {}\n", panel.factor * r.place,
                     factor * r.before_rms_n, factor * r.after_rms_n, factor * r.before_mean_n,
                     factor * r.after_mean_n);
  return data;
}

std::string lines_of(const Panel& panel, bool named) {
  std::string out = fmt::format(
      "plot $residual using 1:2 with lines lw 2 lc rgb '{0}' title '{2}', "
      "'' using 1:3 with lines lw 2 lc rgb '{1}' title '{3}'",
      kPlotOrange, kPlotBlue, named ? "rms before" : "", named ? "rms after" : "");
  if (panel.mean)
    out += fmt::format(
        ", '' using 1:4 with lines dt 2 lw 1.4 lc rgb '{0}' title '{2}', "
        "'' using 1:5 with lines dt 2 lw 1.4 lc rgb '{1}' title '{3}'",
        kPlotOrange, kPlotBlue, named ? "mean before" : "", named ? "mean after" : "");
  return out + "\n";
}

}  // namespace

PlotScript plot_residual(const Evidence& evidence) {
  if (evidence.residual.empty()) return {};
  double largest = 0.0;
  for (const ResidualRow& r : evidence.residual) largest = std::max(largest, r.before_rms_n);
  const PlotUnit unit = plot_unit("N", largest);
  std::string script = fmt::format(
      "{}set key at screen 0.985,0.995 right top horizontal maxrows 1 samplen 2 noopaque\n"
      "set multiplot\n",
      kPlotFrame);
  bool named = true;
  for (const Panel& p : kPanels) {
    const std::string data = data_of(evidence, p, unit.factor);
    if (data.empty()) continue;
    script += fmt::format(
        "$residual << EOD\n{}EOD\nset lmargin at screen {}\nset rmargin at screen {}\n"
        "set bmargin at screen {}\nset tmargin at screen {}\nset xlabel '{}'\n"
        "set ylabel 'force left ({})' offset 0.5\n{}",
        data, p.left, p.right, p.bottom, p.top, p.label, unit.name,
        p.over == "frequency_hz" ? "set logscale x\n" : "unset logscale x\n");
    script += lines_of(p, named);
    named = false;
  }
  return {script + "unset multiplot\n", 960, 620};
}

}  // namespace dampline::app

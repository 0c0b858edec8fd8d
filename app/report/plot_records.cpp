// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/report/plot_style.hpp"
#include "app/report/plots.hpp"

namespace dampline::app {
namespace {

constexpr std::size_t kMaxPlotted = 3000;  // points of one line; more is not seen

std::size_t stride_of(std::size_t count) {
  return std::max<std::size_t>(1, (count + kMaxPlotted - 1) / kMaxPlotted);
}

}  // namespace

PlotScript plot_motion(const RunResult& result) {
  if (result.motion.size() < 2) return {};
  std::string script = fmt::format("{}{}{}", kPlotFrame, kPlotKeyAbove, "$motion << EOD\n");
  for (std::size_t i = 0; i < result.motion.size(); i += stride_of(result.motion.size())) {
    const MotionRow& r = result.motion[i];
    script += fmt::format("{} {} {}\n", r.time_s, 1e3 * r.deflection_m, 1e3 * r.velocity_mps);
  }
  script += fmt::format("EOD\nset multiplot\nset xrange [{}:{}]\n", result.motion.front().time_s,
                        result.motion.back().time_s);
  script += fmt::format(
      "set tmargin at screen 0.94\nset bmargin at screen 0.59\nset format x ''\nset ylabel 'y "
      "(mm)'\n"
      "plot $motion using 1:2 with lines lw 1 lc rgb '{}' title 'relative deflection y'\n"
      "set tmargin at screen 0.52\nset bmargin at screen 0.16\nset format x '%g'\n"
      "set xlabel 'time in the record (s)'\nset ylabel 'v (mm/s)'\n"
      "plot $motion using 1:3 with lines lw 1 lc rgb '{}' title 'relative velocity v'\nunset "
      "multiplot\n",
      kPlotBlue, kPlotOrange);
  return {script, 960, 480};
}

PlotScript plot_force(const RunResult& result) {
  if (result.force.size() < 2) return {};
  std::string script = fmt::format("{}{}{}", kPlotFrame, kPlotKeyAbove, "$force << EOD\n");
  for (std::size_t i = 0; i < result.force.size(); i += stride_of(result.force.size())) {
    const ForceRow& r = result.force[i];
    script +=
        fmt::format("{} {} {} {}\n", r.time_s, 1e3 * r.velocity_mps, r.measured_n, r.fitted_n);
  }
  script += fmt::format(
      "EOD\nset multiplot\nset ylabel 'force (N)'\nset tmargin at screen 0.955\nset bmargin at "
      "screen 0.6\n"
      "set xlabel 'time in the record (s)'\nset xrange [{2}:{3}]\n"
      "plot $force using 1:3 with lines lw 1.4 lc rgb '{0}' title 'measured', '' using 1:4 with "
      "lines "
      "lw 1.4 lc rgb '{1}' title 'fitted'\n"
      "set tmargin at screen 0.475\nset bmargin at screen 0.115\nset xlabel 'velocity (mm/s)'\n"
      "set xrange [*:*]\nplot $force using 2:3 with points pt 7 ps 0.18 lc rgb '{0}' title "
      "'measured', "
      "'' using 2:4 with points pt 7 ps 0.18 lc rgb '{1}' title 'fitted'\nunset multiplot\n",
      kPlotBlue, kPlotOrange, result.force.front().time_s, result.force.back().time_s);
  return {script, 960, 640};
}

PlotScript plot_excluded(const RunResult& result) {
  if (result.excluded.empty()) return {};
  std::map<std::string, std::size_t> row_of;
  for (const Excluded& e : result.excluded) row_of.emplace(e.reason, row_of.size());
  std::string script =
      fmt::format("{}{}", kPlotFrame, "unset key\nset lmargin at screen 0.2\n$spans << EOD\n");
  for (const Excluded& e : result.excluded) {
    const auto row = static_cast<double>(row_of[e.reason]);
    script += fmt::format("{} {} {} {} {} {}\n", 0.5 * (e.start_s + e.end_s), row, e.start_s,
                          e.end_s, row - 0.35, row + 0.35);
  }
  script += fmt::format("EOD\nset xrange [0:{}]\nset yrange [-0.6:{}]\n",
                        std::max(result.duration_s, result.excluded.back().end_s),
                        static_cast<double>(row_of.size()) - 0.4);
  script += "set ytics scale 0 (";
  std::string_view comma;
  for (const auto& [reason, row] : row_of) {
    script += fmt::format("{}'{}' {}", comma, plot_label(reason), row);
    comma = ",";
  }
  script += fmt::format(
      ")\nunset grid\nset xlabel 'time in the record (s)'\nset style fill solid 0.8 border lc rgb "
      "'{0}'\n"
      "plot $spans using 1:2:3:4:5:6 with boxxyerror lc rgb '{0}'\n",
      kPlotOrange);
  return {script, 960, 90 + 40 * static_cast<int>(row_of.size())};
}

}  // namespace dampline::app

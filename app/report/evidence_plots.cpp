// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>
#include <vector>

#include "app/report/gnuplot.hpp"
#include "app/report/plots.hpp"

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
  const PlotUnit unit = force_unit(evidence.residual, &ResidualRow::before_rms_n);
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
  double bottom = 0.0;
  double top = 0.0;
  for (const LoopRow& r : evidence.loops) {
    bottom = std::min({bottom, kRoom * r.measured_n, kRoom * r.base_n, kRoom * r.final_n});
    top = std::max({top, kRoom * r.measured_n, kRoom * r.base_n, kRoom * r.final_n});
  }
  const PlotUnit unit = force_unit(evidence.loops, &LoopRow::measured_n);
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

namespace {

constexpr double kShownS = 20.0;  // more is not seen

/// The liveliest stretch of a record.
std::vector<PredictedRow> stretch_of(const Evidence& evidence, std::uint32_t record) {
  std::vector<PredictedRow> all;
  for (const PredictedRow& r : evidence.prediction)
    if (r.record == record) all.push_back(r);
  if (all.empty()) return all;
  std::size_t best = 0;
  double most = -1.0;
  double sum = 0.0;
  for (std::size_t from = 0, to = 0; to < all.size(); ++to) {
    sum += all[to].measured_n * all[to].measured_n;
    for (; all[to].time_s - all[from].time_s > kShownS; ++from)
      sum -= all[from].measured_n * all[from].measured_n;
    if (sum <= most) continue;
    most = sum;
    best = from;
  }
  std::vector<PredictedRow> out;
  for (std::size_t i = best; i < all.size() && all[i].time_s - all[best].time_s <= kShownS; ++i)
    out.push_back(all[i]);
  return out;
}

}  // namespace

std::uint32_t predicted_records(const Evidence& evidence) {
  std::uint32_t out = 0;
  for (const PredictedRow& r : evidence.prediction) out = std::max(out, r.record);
  return out;
}

PlotScript plot_prediction(const Evidence& evidence, std::uint32_t record) {
  const std::vector<PredictedRow> rows = stretch_of(evidence, record);
  if (rows.size() < 2) return {};
  const bool reference = std::any_of(
      rows.begin(), rows.end(), [](const PredictedRow& r) { return std::isfinite(r.reference_n); });
  const PlotUnit unit = force_unit(rows, &PredictedRow::measured_n);
  const std::size_t stride = plot_stride(rows.size());
  std::string script = fmt::format("{}{}set tmargin 2\nset datafile missing '?'\n$record << EOD\n",
                                   kPlotFrame, kPlotKeyAbove);
  for (std::size_t i = 0; i < rows.size(); i += stride) {
    const PredictedRow& r = rows[i];
    fmt::format_to(
        std::back_inserter(script), "{} {} {} {} {}\n", r.time_s, unit.factor * r.measured_n,
        unit.factor * r.base_n, unit.factor * r.predicted_n,
        std::isfinite(r.reference_n) ? fmt::format("{}", unit.factor * r.reference_n) : "?");
  }
  script += fmt::format(
      "EOD\nset xlabel 'time in the record (s)'\nset ylabel 'force ({})' offset 0.5\n"
      "plot $record using 1:2 with lines lw 3 lc rgb '#bbbbbb' title 'measured', "
      "'' using 1:3 with lines lw 1 lc rgb '{}' title 'before'",
      unit.name, kPlotOrange);
  if (reference) script += ", '' using 1:5 with lines lw 1 lc rgb '#009e73' title 'reference'";
  script += fmt::format(", '' using 1:4 with lines lw 1.2 lc rgb '{}' title 'after'\n", kPlotBlue);
  return {script, 960, 380};
}

}  // namespace dampline::app

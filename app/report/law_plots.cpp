// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "app/report/gnuplot.hpp"
#include "app/report/plots.hpp"

namespace dampline::app {
namespace {

/// The edges half-way between neighbours; the outermost cells are symmetric.
std::vector<double> cell_edges(const std::vector<CurveRow>& curve) {
  std::vector<double> edges;
  for (std::size_t i = 0; i + 1 < curve.size(); ++i)
    edges.push_back(0.5 * (curve[i].velocity_mps + curve[i + 1].velocity_mps));
  edges.insert(edges.begin(), 2.0 * curve.front().velocity_mps - edges.front());
  edges.push_back(2.0 * curve.back().velocity_mps - edges.back());
  return edges;
}

/// Below this speed the curve is not resolved: the law's width, seen from its middle to its flank.
double resolved_from_mps(const RunResult& result) {
  const auto width = std::find_if(result.parameters.begin(), result.parameters.end(),
                                  [](const Parameter& p) { return p.name == "law_width"; });
  return width == result.parameters.end() ? 0.0 : 1.5 * width->value;
}

/// What is drawn of a curve.
struct Branches {
  std::vector<CurveRow> negative;
  std::vector<CurveRow> positive;
};

/// The resolved part. Of two rows at 0, the first belongs to v < 0 and the second to v > 0.
Branches resolved(const std::vector<CurveRow>& curve, double from_mps) {
  Branches out;
  bool past_zero = false;
  for (const CurveRow& r : curve) {
    const bool positive = r.velocity_mps > 0.0 || past_zero;
    past_zero = past_zero || r.velocity_mps == 0.0;
    if (std::fabs(r.velocity_mps) < from_mps) continue;
    (positive ? out.positive : out.negative).push_back(r);
  }
  return out;
}

/// Columns: v in mm/s, F, its deviation, side; and the jump that joins the branches.
std::string curve_data(const Branches& curve, double factor) {
  std::string data = "$curve << EOD\n";
  const auto add = [&](const std::vector<CurveRow>& rows, int side) {
    for (const CurveRow& r : rows)
      data += fmt::format("{} {} {} {}\n", 1e3 * r.velocity_mps, factor * r.force_n,
                          factor * r.std_n, side);
  };
  add(curve.negative, -1);
  add(curve.positive, 1);
  data += "EOD\n$jump << EOD\n";
  if (!curve.negative.empty() && !curve.positive.empty()) {
    const CurveRow& left = curve.negative.back();
    const CurveRow& right = curve.positive.front();
    data += fmt::format("{} {}\n0 {}\n0 {}\n{} {}\n", 1e3 * left.velocity_mps,
                        factor * left.force_n, factor * left.force_n, factor * right.force_n,
                        1e3 * right.velocity_mps, factor * right.force_n);
  }
  return data + "EOD\n";
}

std::string support_data(const std::vector<CurveRow>& curve) {
  std::string data = "$support << EOD\n";
  std::vector<CurveRow> cells;  // the two sides of the jump at 0 support no cell of their own
  std::copy_if(curve.begin(), curve.end(), std::back_inserter(cells),
               [](const CurveRow& r) { return r.velocity_mps != 0.0; });
  if (cells.size() < 2) return data + "EOD\n";
  const std::vector<double> edges = cell_edges(cells);
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (cells[i].samples > 0)
      data += fmt::format("{} {} {} {} {} {}\n", 1e3 * cells[i].velocity_mps, cells[i].samples,
                          1e3 * edges[i], 1e3 * edges[i + 1], 0.7, cells[i].samples);
  return data + "EOD\n";
}

std::string unresolved_zone(double from_mps) {
  if (!(from_mps > 0.0)) return "";
  return fmt::format(
      "set object 1 rect from {0},graph 0 to {1},graph 1 behind fc rgb '#eeeeee' fs solid "
      "noborder\n",
      -1e3 * from_mps, 1e3 * from_mps);
}

/// Each branch by itself, so that nothing joins them but the jump.
std::string branches(std::string_view sign) {
  return fmt::format(
      "for [side in '-1 1'] $curve using ($4==side ? $1 : NaN):({1}*$2-2*$3):({1}*$2+2*$3) with "
      "filledcurves lc rgb '{0}' title (side > 0 ? '± 2 standard deviations' : ''), "
      "for [side in '-1 1'] '' using ($4==side ? $1 : NaN):({1}*$2) with linespoints lw 2 pt 7 "
      "ps 0.45 lc rgb '{0}' title (side > 0 ? 'damping force' : '')",
      kPlotBlue, sign);
}

std::string curve_panel(const std::string& unit, bool has_zone) {
  const std::string zone =
      has_zone ? ", NaN with boxes lc rgb '#bbbbbb' fs solid 0.5 title 'not resolved'" : "";
  return fmt::format(
      "set tmargin at screen 0.97\nset bmargin at screen 0.55\nset format x ''\n"
      "set ylabel 'damping force F ({})' offset 0.5\nset key bottom right\n"
      "set xzeroaxis lc rgb '#999999'\n"
      "plot {}, $jump using 1:2 with lines dt 2 lw 1.5 lc rgb '{}' title 'jump'{}\n",
      unit, branches("1"), kPlotBlue, zone);
}

/// The jump dwarfs everything else: the same curve against the direction of motion, enlarged.
std::string enlarged_panel(const std::string& unit) {
  return fmt::format(
      "set tmargin at screen 0.49\nset bmargin at screen 0.29\nunset xzeroaxis\nunset key\n"
      "set title 'the same curve times the sign of v, enlarged' offset 0,-0.8 font ',13'\n"
      "set ylabel 'F sign v ({})' offset 0.5\nplot {}\n",
      unit, branches("side"));
}

std::string support_panel() {
  return fmt::format(
      "unset object 1\nset tmargin at screen 0.235\nset bmargin at screen 0.095\n"
      "set format x '%g'\nset xlabel 'relative velocity v (mm/s)'\n"
      "set title 'samples that support each part' offset 0,-0.8 font ',13'\n"
      "set ylabel 'samples' offset 0.5\nset logscale y\nset mytics 1\n"
      "set format y '10^{{%T}}'\nset yrange [0.7:*]\nset style fill solid 0.5 noborder\n"
      "plot $support using 1:2:3:4:5:6 with boxxyerror lc rgb '{}'\n",
      kPlotOrange);
}

}  // namespace

PlotScript plot_curve(const RunResult& result) {
  if (result.curve.empty()) return {};
  const double fastest_mps = std::max(std::fabs(result.curve.front().velocity_mps),
                                      std::fabs(result.curve.back().velocity_mps));
  const double limit = 1.05e3 * fastest_mps;
  const PlotUnit unit = force_unit(result.curve, &CurveRow::force_n);
  const double from_mps = resolved_from_mps(result);
  // Where not one velocity is resolved, all are drawn, and the grey zone says so.
  const double drawn_from_mps = from_mps < fastest_mps ? from_mps : 0.0;
  std::string script{kPlotFrame};
  script +=
      curve_data(resolved(result.curve, drawn_from_mps), unit.factor) + support_data(result.curve);
  script += fmt::format("set multiplot\nset xrange [{}:{}]\n", -limit, limit);
  script += unresolved_zone(from_mps) + curve_panel(unit.name, from_mps > 0.0) +
            enlarged_panel(unit.name) + support_panel();
  return {script + "unset multiplot\n", 960, 720};
}

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
  const PlotUnit unit = force_unit(result.curve, &CurveRow::force_n);
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

PlotScript plot_law(const Evidence& evidence) {
  if (evidence.law.size() < 2) return {};
  const PlotUnit unit = force_unit(evidence.law, &LawRow::final_n);
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

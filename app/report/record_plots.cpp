// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "app/report/gnuplot.hpp"
#include "app/report/html.hpp"
#include "app/report/plots.hpp"
#include "app/report/sections.hpp"
#include "app/text/format.hpp"
#include "app/text/summary.hpp"

namespace dampline::app {

PlotScript plot_motion(const RunResult& result) {
  if (result.motion.size() < 2) return {};
  std::string script = fmt::format("{}{}{}", kPlotFrame, kPlotKeyAbove, "$motion << EOD\n");
  for (std::size_t i = 0; i < result.motion.size(); i += plot_stride(result.motion.size())) {
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
  for (std::size_t i = 0; i < result.force.size(); i += plot_stride(result.force.size())) {
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

namespace {

struct Moments {
  double mean{0.0};
  double std{0.0};
};

Moments moments_of(const DensityTable& table) {
  double sum = 0.0;
  double first = 0.0;
  double second = 0.0;
  for (const DensityRow& r : table.rows) {
    sum += r.density;
    first += r.density * r.centre;
    second += r.density * r.centre * r.centre;
  }
  if (!(sum > 0.0)) return {};
  const double mean = first / sum;
  return {mean, std::sqrt(std::max(0.0, second / sum - mean * mean))};
}

/// In mm and mm/s. Columns: centre, density, normal density.
std::string density_data(const DensityTable& table, std::size_t number) {
  const Moments m = moments_of(table);
  std::string data = fmt::format("$density{} << EOD\n", number);
  for (const DensityRow& r : table.rows) {
    const double z = m.std > 0.0 ? (r.centre - m.mean) / m.std : 0.0;
    const double normal =
        m.std > 0.0 ? std::exp(-0.5 * z * z) / (m.std * std::sqrt(2.0 * std::numbers::pi)) : 0.0;
    data += fmt::format("{} {} {}\n", 1e3 * r.centre, 1e-3 * r.density, 1e-3 * normal);
  }
  return data + "EOD\n";
}

bool is_velocity(const DensityTable& table) { return table.quantity == "velocity_mps"; }

}  // namespace

PlotScript plot_densities(const RunResult& result) {
  if (result.densities.empty()) return {};
  std::string script = fmt::format("{}unset key\n", kPlotFrame);
  for (std::size_t i = 0; i < result.densities.size(); ++i)
    script += density_data(result.densities[i], i);
  script += fmt::format("set multiplot layout 1,{}\nset yrange [0:*]\n", result.densities.size());
  for (std::size_t i = 0; i < result.densities.size(); ++i) {
    const bool velocity = is_velocity(result.densities[i]);
    const double left = 0.09 + 0.5 * static_cast<double>(i);
    script += fmt::format(
        "set lmargin at screen {:.2f}\nset rmargin at screen {:.2f}\n"
        "set xlabel '{}'\nset ylabel 'density ({})'\n"
        "plot $density{} using 1:2 with boxes fs solid 0.45 noborder lc rgb '{}', "
        "'' using 1:3 with lines lw 1.2 lc rgb '#555555'\n",
        left, left + 0.39, velocity ? "relative velocity v (mm/s)" : "relative deflection y (mm)",
        velocity ? "s/mm" : "1/mm", i, velocity ? kPlotOrange : kPlotBlue);
  }
  return {script + "unset multiplot\n", 960, 380};
}

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

namespace {

constexpr std::size_t kMostTicks = 4000;  // per kind; more would be one black bar all the same

}  // namespace

PlotScript plot_events(const RunResult& result) {
  if (result.events.empty()) return {};
  std::map<std::string, std::vector<double>> times;
  for (const RunEvent& e : result.events) times[e.name].push_back(e.time_s);
  std::string script =
      fmt::format("{}{}", kPlotFrame, "unset key\nset lmargin at screen 0.2\n$events << EOD\n");
  std::string labels;
  std::size_t row = 0;
  for (const auto& [name, moments] : times) {
    const std::size_t stride = (moments.size() + kMostTicks - 1) / kMostTicks;
    for (std::size_t i = 0; i < moments.size(); i += stride)
      script += fmt::format("{} {} 0 0.6\n", moments[i], static_cast<double>(row) - 0.3);
    labels += fmt::format("{}'{}' {}", row == 0 ? "" : ",", plot_label(name), row);
    ++row;
  }
  const double first = std::min(0.0, result.events.front().time_s);
  const double last = std::max(result.duration_s, result.events.back().time_s);
  const double margin = 0.01 * (last - first);
  script += fmt::format(
      "EOD\nset xrange [{}:{}]\nset yrange [-0.6:{}]\nset ytics scale 0 ({})\nunset grid\n"
      "set xlabel 'time in the record (s)'\n"
      "plot $events using 1:2:3:4 with vectors nohead lw 1.6 lc rgb '{}'\n",
      first - margin, last + margin, static_cast<double>(row) - 0.4, labels, kPlotBlue);
  return {script, 960, 90 + 32 * static_cast<int>(row)};
}

namespace {

constexpr double kLeastUs = 1e-3;  // a nanosecond: a logarithmic axis has no 0

struct Mark {
  const char* name;
  double us;
};

std::string lateness_data(const std::vector<LatenessRow>& rows) {
  std::string data = "$lateness << EOD\n";
  for (const LatenessRow& r : rows)
    data += fmt::format("{} {} {}\n", std::max(r.from_us, kLeastUs), std::max(r.to_us, kLeastUs),
                        r.frames);
  return data + "EOD\n";
}

/// A line and its name for each, one below the other so that no name covers another.
std::string marks_of(const LiveFigures& f) {
  const std::array<Mark, 5> marks{{{"p50", f.lateness_p50_us},
                                   {"p90", f.lateness_p90_us},
                                   {"p99", f.lateness_p99_us},
                                   {"p99.9", f.lateness_p999_us},
                                   {"largest", f.lateness_max_us}}};
  std::string script;
  double height = 0.95;
  for (const Mark& mark : marks) {
    const double x = std::max(mark.us, kLeastUs);
    script += fmt::format(
        "set arrow from {0},graph 0 to {0},graph {1:.2f} nohead lw 1.2 lc rgb '{2}' front\n"
        "set label '{3} {4}' at {0},graph {1:.2f} offset 0.4,0 front\n",
        x, height, kPlotOrange, mark.name, format_microseconds(mark.us));
    height -= 0.08;
  }
  return script;
}

}  // namespace

PlotScript plot_lateness(const RunResult& result) {
  if (result.lateness.empty() || !result.live) return {};
  constexpr double kRoomForNames = 8.0;
  const double left = std::max(result.lateness.front().from_us, kLeastUs);
  const double right = kRoomForNames * std::max(result.lateness.back().to_us, kLeastUs);
  std::uint64_t most = 0;
  for (const LatenessRow& r : result.lateness) most = std::max(most, r.frames);
  std::string script = fmt::format("{}unset key\nset logscale xy\n", kPlotFrame);
  script += lateness_data(result.lateness) + marks_of(*result.live);
  // Decades of frames above the highest bar, where the names stand.
  script += fmt::format(
      "set xrange [{}:{}]\nset yrange [0.5:{}]\nset format xy '10^{{%T}}'\n"
      "set xlabel 'from a frame''s stamp to its result (µs)'\nset ylabel 'frames'\n"
      "plot $lateness using 1:(0.5):1:2:(0.5):3 with boxxyerror fs solid 0.45 noborder "
      "lc rgb '{}'\n",
      0.8 * left, right, 2.0 * std::pow(static_cast<double>(most), 1.6), kPlotBlue);
  return {script, 960, 420};
}

namespace {

std::string label_of(const FaultFinding& fault) {
  return plot_label(fault.name) + ", " + fault.channel;
}

std::size_t rank_of(const std::string& channel) {
  constexpr std::array<std::string_view, 5> kOrder{"frame", "wheelset1", "wheelset2", "wheelsets",
                                                   "all"};
  return static_cast<std::size_t>(std::find(kOrder.begin(), kOrder.end(), channel) -
                                  kOrder.begin());
}

/// One line of the figure: a fault of a channel, or a reason to leave blocks out.
struct Lane {
  std::string label;
  std::string size;
  std::vector<Span> spans;
  std::optional<Span> seen;
};

/// Channel by channel; below them what was left out of the estimate.
std::vector<Lane> lanes_of(const RunResult& result) {
  std::vector<const FaultFinding*> sorted;
  for (const FaultFinding& f : result.faults.list) sorted.push_back(&f);
  std::stable_sort(sorted.begin(), sorted.end(), [](const FaultFinding* a, const FaultFinding* b) {
    return rank_of(a->channel) < rank_of(b->channel);
  });
  std::vector<Lane> lanes;
  lanes.reserve(sorted.size() + result.excluded.size());
  for (const FaultFinding* f : sorted)
    lanes.push_back({label_of(*f), fault_size(*f), f->spans, Span{f->time_s, f->last_s}});
  std::map<std::string, std::size_t> lane;
  for (const Excluded& e : result.excluded) {
    const auto [place, is_new] = lane.emplace(e.reason, lanes.size());
    if (is_new) lanes.push_back({"left out: " + plot_label(e.reason), "", {}, std::nullopt});
    lanes[place->second].spans.push_back({e.start_s, e.end_s});
  }
  return lanes;
}

}  // namespace

PlotScript plot_faults(const RunResult& result) {
  if (result.faults.list.empty()) return {};
  const std::vector<Lane> lanes = lanes_of(result);
  std::array<std::string, 2> spans;  // that faults spoil, and that were left out
  std::string seen;
  std::string ticks;
  std::string sizes;
  for (std::size_t row = 0; row < lanes.size(); ++row) {
    const Lane& lane = lanes[row];
    const auto y = static_cast<double>(lanes.size() - 1 - row);
    for (const Span& s : lane.spans)
      spans[lane.seen ? 0 : 1] += fmt::format("{} {} {} {} {} {}\n", 0.5 * (s.start_s + s.end_s), y,
                                              s.start_s, s.end_s, y - 0.3, y + 0.3);
    if (lane.seen)
      seen +=
          fmt::format("{} {} {} 0\n", lane.seen->start_s, y, lane.seen->end_s - lane.seen->start_s);
    ticks += fmt::format("{}'{}' {}", row == 0 ? "" : ",", lane.label, y);
    sizes +=
        fmt::format("set label '{}' at graph 1.01,first {} left tc rgb '#333333'\n", lane.size, y);
  }
  std::string script = fmt::format(
      "{}unset key\nset lmargin at screen 0.27\nset rmargin at screen 0.86\n{}", kPlotFrame, sizes);
  for (std::size_t i = 0; i < spans.size(); ++i)
    if (!spans[i].empty()) script += fmt::format("$spans{} << EOD\n{}EOD\n", i, spans[i]);
  script += fmt::format(
      "$seen << EOD\n{}EOD\nset xrange [0:{}]\nset yrange [-0.6:{}]\nset ytics scale 0 ({})\n"
      "unset grid\nset xlabel 'time in the record (s)'\nset style fill solid 0.6 noborder\nplot ",
      seen, std::max(result.duration_s, 1.0), static_cast<double>(lanes.size()) - 0.4, ticks);
  constexpr std::array<std::string_view, 2> kColours{kPlotOrange, "#888888"};
  for (std::size_t i = 0; i < spans.size(); ++i)
    if (!spans[i].empty())
      script +=
          fmt::format("$spans{} using 1:2:3:4:5:6 with boxxyerror lc rgb '{}', ", i, kColours[i]);
  script += fmt::format(
      "$seen using 1:2:3:4 with vectors nohead lw 2 lc rgb '{0}', "
      "'' using 1:2 with points pt 7 ps 0.6 lc rgb '{0}'\n",
      kPlotBlue);
  return {script, 960, 90 + 34 * static_cast<int>(lanes.size())};
}

}  // namespace dampline::app

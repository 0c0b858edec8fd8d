// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/report/plot_style.hpp"
#include "app/report/plots.hpp"
#include "app/text/quantity.hpp"

namespace dampline::app {
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

}  // namespace dampline::app

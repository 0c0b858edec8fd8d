// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "app/report/plot_style.hpp"
#include "app/report/plots.hpp"

namespace dampline::app {
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

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include "app/report/gnuplot.hpp"

#include <fmt/format.h>

#include "app/report/child.hpp"

namespace dampline::app {

Drawing draw(const PlotScript& plot, const std::string& name) {
  const std::string terminal = fmt::format(
      "set terminal svg size {},{} dynamic name '{}' font 'Helvetica,Arial,DejaVu "
      "Sans,sans-serif,14' "
      "fontscale 0.95 background '#ffffff'\n",
      plot.width, plot.height, name);
  const ChildResult result = run_child({"gnuplot", "-"}, terminal + plot.script);
  if (!result.started) return {"", "gnuplot was not found; install gnuplot-nox for the plots"};
  const std::size_t begin = result.output.find("<svg");
  const std::size_t end = result.output.rfind("</svg>");
  if (result.status != 0 || begin == std::string::npos || end == std::string::npos)
    return {"", fmt::format("gnuplot failed (exit {}): {}", result.status,
                            result.error.substr(0, 400))};
  return {result.output.substr(begin, end + 6 - begin), ""};
}

}  // namespace dampline::app

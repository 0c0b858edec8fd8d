// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/report/plots.hpp"

namespace dampline::app {

/// An <svg> element to stand inside a page, or the reason why there is none.
struct Drawing {
  std::string svg;
  std::string problem;
};

/// Runs gnuplot as a child process. `name` keeps the identifiers of several drawings on one page
/// apart.
[[nodiscard]] Drawing draw(const PlotScript& plot, const std::string& name);

}  // namespace dampline::app

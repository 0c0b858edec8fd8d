// SPDX-License-Identifier: MIT
// Estimates over time, as pages of many runs draw them.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "app/report/svg/panel.hpp"
#include "app/run/result.hpp"

namespace dampline::app::compare {

/// What one truck's runs have, in the order of the axis.
struct Series {
  std::vector<std::pair<double, Parameter>> points;
};

/// Band, bars and dots: two standard deviations; `factor` to the axis's unit.
void add_series(const Series& series, double factor, svg::Ink ink, const std::string& name,
                svg::Panel& panel);

}  // namespace dampline::app::compare

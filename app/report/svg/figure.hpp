// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "app/report/svg/panel.hpp"

namespace dampline::app {

/// Panels that belong together; none where the result has nothing to draw.
struct Plot {
  std::vector<svg::Panel> panels;
  bool side_by_side{false};  ///< where the page is wide enough; else one below the other
};

/// The panels as a <figure>, `name` in their identifiers; "" where there is nothing to draw.
[[nodiscard]] std::string figure(const Plot& plot, const std::string& name,
                                 std::string_view caption);

}  // namespace dampline::app

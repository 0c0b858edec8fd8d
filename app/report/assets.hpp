// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>

namespace dampline::app {

// What every page carries in itself, from the files beside this one.

[[nodiscard]] std::string_view page_style();    ///< page.css, with that of uPlot
[[nodiscard]] std::string_view uplot_script();  ///< uplot/uPlot.iife.min.js
[[nodiscard]] std::string_view plots_script();  ///< plots.js

/// The end of a page's head: style, and the policy by which no script runs but the page's own,
/// nothing is fetched and nothing sent, whatever stands in the body.
[[nodiscard]] std::string page_head();
/// The end of a page's body: the scripts that make its drawings plots to enlarge and read.
[[nodiscard]] std::string page_scripts();

}  // namespace dampline::app

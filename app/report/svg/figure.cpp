// SPDX-License-Identifier: MIT
#include "app/report/svg/figure.hpp"

#include <fmt/format.h>

#include "app/report/html.hpp"

namespace dampline::app {

std::string figure(const Plot& plot, const std::string& name, std::string_view caption) {
  if (plot.panels.empty()) return "";
  std::string drawn;
  for (std::size_t i = 0; i < plot.panels.size(); ++i)
    drawn += fmt::format(
        "<div class=\"panel\">{}<script type=\"application/json\">{}</script></div>\n",
        plot.panels[i].draw(fmt::format("{}-{}", name, i + 1), caption), plot.panels[i].data());
  return fmt::format(
      "<figure><div class=\"panels{}\">\n{}</div>\n<figcaption>{}</figcaption></figure>\n",
      plot.side_by_side ? " beside" : "", drawn, escape_html(caption));
}

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include "app/report/html.hpp"

#include <fmt/format.h>

namespace dampline::app {

std::string escape_html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        // No other control character is allowed in a page.
        if (static_cast<unsigned char>(c) >= ' ' || c == '\n' || c == '\t')
          out += c;
        else
          out += "\u2423";
    }
  }
  return out;
}

std::string html_table(const std::vector<std::string>& header,
                       const std::vector<std::vector<std::string>>& rows, std::size_t numbers) {
  const auto line = [&](const std::vector<std::string>& cells, std::string_view tag) {
    std::string out = "<tr>";
    for (std::size_t i = 0; i < cells.size(); ++i)
      out += fmt::format("<{0}{1}>{2}</{0}>", tag,
                         i >= 1 && i <= numbers ? " class=\"number\"" : "", escape_html(cells[i]));
    return out + "</tr>\n";
  };
  std::string out = "<table><thead>" + line(header, "th") + "</thead><tbody>\n";
  for (const auto& row : rows) out += line(row, "td");
  return out + "</tbody></table>\n";
}

}  // namespace dampline::app

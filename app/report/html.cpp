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

namespace {

/// A word that no line of a page may hold, like a checksum or the path of a file.
bool has_long_word(std::string_view text) {
  constexpr std::size_t kLongest = 30;
  std::size_t length = 0;
  for (const char c : text) {
    length = c == ' ' || c == '\n' ? 0 : length + 1;
    if (length > kLongest) return true;
  }
  return false;
}

std::string lines_of(std::string_view text) {
  std::string out = escape_html(text);
  for (std::size_t at = out.find('\n'); at != std::string::npos; at = out.find('\n', at))
    out.replace(at, 1, "<br>");
  return out;
}

std::string linked(const std::string& html, const std::string& link) {
  return link.empty() ? html : fmt::format("<a href=\"{}\">{}</a>", escape_html(link), html);
}

std::string header_cell(const std::string& name, bool is_number) {
  if (name.empty()) return "<td></td>";  // a heading says something
  return fmt::format(R"(<th role="columnheader" scope="col"{}>{}</th>)",
                     is_number ? R"( class="number")" : "", escape_html(name));
}

}  // namespace

// The roles say again what the elements mean: a phone lays tables out as no tables.
std::string html_table(const std::vector<std::string>& header,
                       const std::vector<std::vector<std::string>>& rows, std::size_t numbers,
                       const std::vector<bool>& grey, const std::vector<std::string>& links) {
  const auto is_number = [&](std::size_t i) { return i >= 1 && i <= numbers; };
  std::string out = fmt::format(R"(<table role="table"{}><thead><tr role="row">)",
                                header.size() > 2 ? " class=\"wide\"" : "");
  for (std::size_t i = 0; i < header.size(); ++i) out += header_cell(header[i], is_number(i));
  out += "</tr></thead><tbody>\n";
  for (std::size_t row = 0; row < rows.size(); ++row) {
    out +=
        row < grey.size() && grey[row] ? R"(<tr role="row" class="grey">)" : R"(<tr role="row">)";
    for (std::size_t i = 0; i < rows[row].size(); ++i) {
      const bool labelled = i > 0 && i < header.size() && !header[i].empty();
      const char* const kind = is_number(i)                  ? R"( class="number")"
                               : has_long_word(rows[row][i]) ? R"( class="long")"
                                                             : "";
      out += fmt::format(R"(<td role="cell"{}{}>{}</td>)", kind,
                         labelled ? fmt::format(R"( data-label="{}")", escape_html(header[i])) : "",
                         i == 0 && row < links.size() ? linked(lines_of(rows[row][i]), links[row])
                                                      : lines_of(rows[row][i]));
    }
    out += "</tr>\n";
  }
  return out + "</tbody></table>\n";
}

std::string html_details(std::string_view summary, const std::string& body) {
  return fmt::format("<details><summary>{}</summary>\n{}</details>\n", escape_html(summary), body);
}

}  // namespace dampline::app

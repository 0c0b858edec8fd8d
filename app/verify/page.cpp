// SPDX-License-Identifier: MIT
#include "app/verify/page.hpp"

#include <fmt/format.h>

#include <vector>

#include "app/report/assets.hpp"
#include "app/report/html.hpp"

namespace dampline::app {
namespace {

/// Cells between the bars of a row; a bar behind a backslash belongs to its cell.
std::vector<std::string> cells_of(std::string_view row) {
  std::vector<std::string> out;
  std::string cell;
  for (std::size_t i = 1; i < row.size(); ++i) {
    if (row[i] == '\\' && i + 1 < row.size() && row[i + 1] == '|') {
      cell += row[++i];
    } else if (row[i] == '|') {
      out.push_back(escape_html(cell));
      cell.clear();
    } else {
      cell += row[i];
    }
  }
  return out;
}

std::string row_of(std::string_view row, const char* element) {
  std::string out = "<tr>";
  for (const std::string& cell : cells_of(row)) out += fmt::format("<{0}>{1}</{0}>", element, cell);
  return out + "</tr>\n";
}

/// What encloses the lines of one kind.
enum class Kind { kText, kTable, kList };

/// Takes what stands before `ends` off the text, and `ends` itself.
std::string_view take_to(std::string_view& text, std::string_view ends) {
  const std::size_t at = text.find(ends);
  const std::string_view out = text.substr(0, at);
  text.remove_prefix(at == std::string_view::npos ? text.size() : at + ends.size());
  return out;
}

Kind kind_of(std::string_view line) {
  if (line.starts_with("|")) return Kind::kTable;
  return line.starts_with("- ") ? Kind::kList : Kind::kText;
}

const char* ends(Kind kind, bool opens) {
  if (kind == Kind::kTable) return opens ? "<table>\n" : "</table>\n";
  if (kind == Kind::kList) return opens ? "<ul>\n" : "</ul>\n";
  return "";
}

std::string line_of(std::string_view line, Kind kind, bool first) {
  if (kind == Kind::kTable) {
    if (line.starts_with("|--")) return "";
    return row_of(line, first ? "th" : "td");
  }
  if (kind == Kind::kList) return "<li>" + escape_html(line.substr(2)) + "</li>\n";
  if (line.starts_with("### ")) return "<h3>" + escape_html(line.substr(4)) + "</h3>\n";
  return line.empty() ? "" : "<p>" + escape_html(line) + "</p>\n";
}

}  // namespace

std::string html_of_markdown(std::string_view markdown) {
  std::string out;
  Kind open = Kind::kText;
  while (!markdown.empty()) {
    if (markdown.starts_with("<figure>")) {
      constexpr std::string_view kEnd = "</figure>\n";
      out += std::string{ends(open, false)}.append(take_to(markdown, kEnd)).append(kEnd);
      open = Kind::kText;
      continue;
    }
    const std::string_view line = take_to(markdown, "\n");
    const Kind kind = kind_of(line);
    const bool first = kind != open;
    if (first) out += std::string{ends(open, false)} + ends(kind, true);
    open = kind;
    out += line_of(line, kind, first);
  }
  return out + ends(open, false);
}

namespace {

/// Tables of many columns, whose short words stay whole; two panels beside each other.
constexpr std::string_view kWide = R"css(body { max-width: 76rem; }
.panels.beside { grid-template-columns: repeat(auto-fit, minmax(min(100%, 24rem), 1fr)); }
@media (max-width: 40rem) { table { display: block; overflow-x: auto; } td { min-width: 5rem; } td:first-child { min-width: 9rem; } td:last-child { min-width: 15rem; } }
)css";

}  // namespace

std::string whole_page(const std::string& heading, const std::string& body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n<title>{0}</title>\n"
      "{1}<style>{3}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n{2}</main>\n{4}</body>\n"
      "</html>\n",
      escape_html(heading), page_head(), body, kWide, page_scripts());
}

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#include "app/verify/page.hpp"

#include <fmt/format.h>

#include <vector>

#include "app/report/html.hpp"

namespace dampline::app {
namespace {

std::string safe(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

/// Cells between the bars of a row; a bar behind a backslash belongs to its cell.
std::vector<std::string> cells_of(std::string_view row) {
  std::vector<std::string> out;
  std::string cell;
  for (std::size_t i = 1; i < row.size(); ++i) {
    if (row[i] == '\\' && i + 1 < row.size() && row[i + 1] == '|') {
      cell += row[++i];
    } else if (row[i] == '|') {
      out.push_back(safe(cell));
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
  if (kind == Kind::kList) return "<li>" + safe(line.substr(2)) + "</li>\n";
  if (line.starts_with("### ")) return "<h3>" + safe(line.substr(4)) + "</h3>\n";
  return line.empty() ? "" : "<p>" + safe(line) + "</p>\n";
}

}  // namespace

std::string html_of_markdown(std::string_view markdown) {
  std::string out;
  Kind open = Kind::kText;
  while (!markdown.empty()) {
    const std::size_t end = markdown.find('\n');
    const std::string_view line = markdown.substr(0, end);
    markdown.remove_prefix(end == std::string_view::npos ? markdown.size() : end + 1);
    const Kind kind = kind_of(line);
    const bool first = kind != open;
    if (first) out += std::string{ends(open, false)} + ends(kind, true);
    open = kind;
    out += line_of(line, kind, first);
  }
  return out + ends(open, false);
}

std::string whole_page(const std::string& heading, const std::string& body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n"
      "<style>{1}body {{ max-width: 90rem; "
      "}}\n</style>\n</head>\n<body>\n<h1>{0}</h1>\n{2}</body>\n"
      "</html>\n",
      safe(heading), kPageStyle, body);
}

}  // namespace dampline::app

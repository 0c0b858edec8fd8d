// SPDX-License-Identifier: MIT
#include "app/run/csv_text.hpp"

#include <fmt/format.h>

#include <charconv>

#include "app/error.hpp"

namespace dampline::app {
namespace {

std::string_view next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

Cells split(std::string_view line) {
  Cells cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t comma = std::min(line.find(',', begin), line.size());
    cells.push_back(line.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return cells;
}

}  // namespace

double number(std::string_view cell) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc{} || end != cell.data() + cell.size())
    throw RunError{fmt::format("\"{}\" is no number", cell)};
  return value;
}

std::vector<std::string> read_rows(std::string_view text, const std::string& origin,
                                   const std::function<void(const Cells&)>& row) {
  const Cells header = split(next_line(text));
  for (int line = 2; !text.empty(); ++line) {
    const Cells cells = split(next_line(text));
    try {
      if (cells.size() != header.size())
        throw RunError{fmt::format("{} cells, expected {}", cells.size(), header.size())};
      row(cells);
    } catch (const RunError& error) {
      throw RunError{fmt::format("{}:{}: {}", origin, line, error.what())};
    }
  }
  return {header.begin(), header.end()};
}

}  // namespace dampline::app

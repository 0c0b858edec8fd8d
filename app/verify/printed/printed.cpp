// SPDX-License-Identifier: MIT
#include "app/verify/printed/printed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

namespace dampline::app {
namespace {

double number(std::string text) {
  text.erase(std::remove(text.begin(), text.end(), ' '), text.end());
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0')
    throw std::invalid_argument{fmt::format("published figures: '{}' is no number", text)};
  return value;
}

}  // namespace

Printed::Printed(std::string as_printed) : text{std::move(as_printed)}, value{number(text)} {}

const std::string& PrintedTable::text(const std::string& row, const std::string& column) const {
  const auto at_row = std::find_if(rows.begin(), rows.end(),
                                   [&](const PrintedRow& one) { return one.name == row; });
  const auto at = std::find(columns.begin(), columns.end(), column);
  if (at_row == rows.end() || at == columns.end())
    throw std::invalid_argument{
        fmt::format("published figures: table {} has no {}, {}", name, row, column)};
  return at_row->figures.at(static_cast<std::size_t>(at - columns.begin()));
}

const PrintedTable& printed_table(const std::vector<PrintedTable>& paper, const std::string& name) {
  for (const PrintedTable& table : paper) {
    if (table.name == name) return table;
  }
  throw std::invalid_argument{fmt::format("published figures: no table {}", name)};
}

}  // namespace dampline::app

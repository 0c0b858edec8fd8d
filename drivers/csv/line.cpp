// SPDX-License-Identifier: MIT
#include "drivers/csv/line.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

namespace dampline::drivers {
namespace {

constexpr std::size_t kLongestNumber = 64;

std::string_view trimmed(std::string_view cell) noexcept {
  while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) cell.remove_prefix(1);
  while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t')) cell.remove_suffix(1);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
    cell = cell.substr(1, cell.size() - 2);
  return cell;
}

/// Where the separator stands outside quotes, or the line's length.
std::size_t end_of_cell(std::string_view rest, char separator) noexcept {
  bool quoted = false;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (rest[i] == '"') quoted = !quoted;
    if (rest[i] == separator && !quoted) return i;
  }
  return rest.size();
}

/// Words that programs write where they have no number.
bool stands_for_none(std::string_view cell) noexcept {
  constexpr std::array<std::string_view, 6> kWords{"na", "n/a", "#n/a", "null", "none", "-"};
  return std::any_of(kWords.begin(), kWords.end(), [cell](std::string_view word) {
    return std::equal(cell.begin(), cell.end(), word.begin(), word.end(), [](char a, char b) {
      return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
    });
  });
}

bool parse(std::string_view text, double& number) noexcept {
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, number);
  return result.ec == std::errc{} && result.ptr == end;
}

}  // namespace

std::string_view take_cell(std::string_view& rest, char separator, bool& more) noexcept {
  const std::size_t end = end_of_cell(rest, separator);
  const std::string_view cell = trimmed(rest.substr(0, end));
  more = end < rest.size();
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return cell;
}

char separator_of(std::string_view header) noexcept {
  std::array<std::size_t, 3> counts{};
  constexpr std::array<char, 3> kSeparators{',', ';', '\t'};
  bool quoted = false;
  for (const char c : header) {
    if (c == '"') quoted = !quoted;
    for (std::size_t i = 0; i < kSeparators.size() && !quoted; ++i)
      counts[i] += c == kSeparators[i] ? 1U : 0U;
  }
  const auto most = std::max_element(counts.begin(), counts.end());
  return kSeparators[static_cast<std::size_t>(most - counts.begin())];
}

std::vector<std::string> cells_of(std::string_view header, char separator) {
  std::vector<std::string> cells;
  bool more = true;
  while (more) cells.emplace_back(take_cell(header, separator, more));
  return cells;
}

bool read_number(std::string_view cell, char separator, double& number) noexcept {
  if (cell.empty() || stands_for_none(cell)) {
    number = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  if (cell.front() == '+' && cell.size() > 1 && cell[1] != '-') cell.remove_prefix(1);
  const std::size_t comma = separator == ',' ? std::string_view::npos : cell.find(',');
  if (comma == std::string_view::npos) return parse(cell, number);
  std::array<char, kLongestNumber> copy{};
  if (cell.size() > copy.size()) return false;
  std::copy(cell.begin(), cell.end(), copy.begin());
  copy[comma] = '.';
  return parse({copy.data(), cell.size()}, number);
}

}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#include "drivers/csv/line.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <limits>

#include "drivers/text/cursor.hpp"

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

/// Any number of blanks and tabs are one separator; those before the first cell are none.
std::string_view take_blank_cell(std::string_view& rest, bool& more) noexcept {
  const auto skip = [&rest] {
    while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
  };
  skip();
  bool quoted = false;
  std::size_t end = 0;
  for (; end < rest.size() && (quoted || !is_blank(rest[end])); ++end)
    if (rest[end] == '"') quoted = !quoted;
  const std::string_view cell = trimmed(rest.substr(0, end));
  rest.remove_prefix(end);
  skip();
  more = !rest.empty();
  return cell;
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
  if (separator == ' ') return take_blank_cell(rest, more);
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
  bool more = false;
  std::string_view rest = header;
  static_cast<void>(take_blank_cell(rest, more));
  if (*most == 0 && more) return ' ';
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

namespace {

/// Digits at the front of `text`; negative: there are not so many.
int take_digits(std::string_view& text, std::size_t count) noexcept {
  int out = 0;
  if (text.size() < count) return -1;
  for (std::size_t i = 0; i < count; ++i) {
    if (text[i] < '0' || text[i] > '9') return -1;
    out = out * 10 + (text[i] - '0');
  }
  text.remove_prefix(count);
  return out;
}

bool take_mark(std::string_view& text, std::string_view marks) noexcept {
  if (text.empty() || marks.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

/// ".123456789" or ",123", in ns; 0: there is none.
std::int64_t take_fraction(std::string_view& text) noexcept {
  if (text.size() < 2 || !take_mark(text, ".,")) return 0;
  std::int64_t unit = 100'000'000;
  std::int64_t out = 0;
  for (; !text.empty() && text.front() >= '0' && text.front() <= '9'; text.remove_prefix(1)) {
    out += (text.front() - '0') * unit;
    unit /= 10;
  }
  return out;
}

/// "Z", "+02:00", "-0130", or nothing, in minutes.
bool take_zone(std::string_view& text, int& minutes, bool& named) noexcept {
  named = true;
  if (take_mark(text, "Z")) return true;
  const bool west = text.starts_with('-');
  named = take_mark(text, "+-");
  if (!named) return true;
  const int hours = take_digits(text, 2);
  static_cast<void>(take_mark(text, ":"));
  const int rest = text.empty() ? 0 : take_digits(text, 2);
  if (hours < 0 || hours > 14 || rest < 0 || rest > 59) return false;
  minutes = (west ? -1 : 1) * (hours * 60 + rest);
  return true;
}

}  // namespace

std::optional<Stamp> read_stamp(std::string_view cell) noexcept {
  const int year = take_digits(cell, 4);
  if (year < 1970 || year > 2200 || !take_mark(cell, "-/")) return std::nullopt;
  const int month = take_digits(cell, 2);
  if (month < 0 || !take_mark(cell, "-/")) return std::nullopt;
  const int day = take_digits(cell, 2);
  if (day < 0 || !take_mark(cell, "T ")) return std::nullopt;
  const int hour = take_digits(cell, 2);
  if (hour < 0 || hour > 23 || !take_mark(cell, ":")) return std::nullopt;
  const int minute = take_digits(cell, 2);
  const bool has_seconds = take_mark(cell, ":");
  const int second = has_seconds ? take_digits(cell, 2) : 0;
  if (minute < 0 || minute > 59 || second < 0 || second > 60) return std::nullopt;
  const std::int64_t fraction_ns = take_fraction(cell);
  int zone_min = 0;
  Stamp out;
  if (!take_zone(cell, zone_min, out.zone_is_named) || !cell.empty()) return std::nullopt;
  using namespace std::chrono;
  const year_month_day date{std::chrono::year{year},
                            std::chrono::month{static_cast<unsigned>(month)},
                            std::chrono::day{static_cast<unsigned>(day)}};
  if (!date.ok()) return std::nullopt;
  const std::int64_t days = sys_days{date}.time_since_epoch().count();
  const std::int64_t minutes = (days * 24 + hour) * 60 + minute - zone_min;
  out.utc_ns = (minutes * 60 + second) * 1'000'000'000 + fraction_ns;
  return out;
}

}  // namespace dampline::drivers

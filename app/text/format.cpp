// SPDX-License-Identifier: MIT
#include "app/text/format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <vector>

#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

constexpr int kMaxDecimals = 9;
constexpr double kSmallestGroup = 1e5;  // shorter numbers are read without grouping

/// Groups of three before the decimal point, for numbers of six digits and more.
std::string group(std::string text, const std::string& separator) {
  const std::size_t first = text.front() == '-' ? 1 : 0;
  std::size_t end = std::min(text.find('.'), text.size());
  while (end > first + 3) {
    end -= 3;
    text.insert(end, separator);
  }
  return text;
}

std::string fixed(double value, int decimals) {
  // Digits that the deviation does not support are rounded away before the point, too.
  const double unit = std::pow(10.0, -decimals);
  const double rounded = decimals < 0 ? std::round(value / unit) * unit : value;
  const std::string text = fmt::format("{:.{}f}", rounded, std::max(decimals, 0));
  return std::fabs(value) >= kSmallestGroup ? group(text, " ") : text;
}

}  // namespace

QuantityText format_quantity(double value, double std) {
  if (!std::isfinite(value)) return {"unknown", ""};
  if (!(std > 0.0) || !std::isfinite(std)) return {fmt::format("{:.6g}", value), ""};
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(std)));
  if (decimals > kMaxDecimals) return {fmt::format("{:.9g}", value), fmt::format("{:.2g}", std)};
  return {fixed(value, decimals), fixed(std, decimals)};
}

ReadUnit read_unit(std::string_view unit, double value) {
  constexpr double kLargeNpm = 1e5;
  constexpr double kLargeNspm = 1e4;
  if (unit == "m") return {1e3, "mm"};
  if (unit == "m/s") return {1e3, "mm/s"};
  if (unit == "N/m" && std::abs(value) >= kLargeNpm) return {1e-6, "MN/m"};
  if (unit == "N s/m" && std::abs(value) >= kLargeNspm) return {1e-3, "kN s/m"};
  return {1.0, std::string{unit}};
}

std::string quantity_text(double value, double std, std::string_view unit) {
  const ReadUnit read = read_unit(unit, value);
  const QuantityText text = format_quantity(read.factor * value, read.factor * std);
  return fmt::format("{}{}{}{}{}", text.value, text.std.empty() ? "" : " ± ", text.std,
                     read.name.empty() ? "" : " ", read.name);
}

std::string format_count(std::uint64_t count, const std::string& separator) {
  return group(fmt::format("{}", count), separator);
}

std::string format_microseconds(double us) {
  return us < 1e4 ? fmt::format("{:.0f} µs", us) : fmt::format("{:.0f} ms", 1e-3 * us);
}

std::string format_duration(double seconds) {
  if (seconds < 60.0) return fmt::format("{:.3g} s", seconds);
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  const std::int64_t unit = whole < 3600 ? 60 : 3600;
  const std::string large = fmt::format("{} {}", whole / unit, unit == 60 ? "min" : "h");
  const std::int64_t rest = whole % unit / (unit / 60);
  return rest == 0 ? large : fmt::format("{} {} {}", large, rest, unit == 60 ? "s" : "min");
}

std::string columns_text(const std::vector<std::vector<std::string>>& rows) {
  constexpr std::size_t kBetween = 2;
  const auto width_of = [](const std::string& text) {
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
      return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U;
    }));
  };
  std::vector<std::size_t> widths(rows.empty() ? 0 : rows.front().size(), 0);
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  std::string out;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i)
      if (widths[i] > 0) line += row[i] + std::string(widths[i] - width_of(row[i]) + kBetween, ' ');
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

std::string without(std::string text, std::string_view unwanted) {
  std::replace_if(
      text.begin(), text.end(),
      [&](char c) {
        return unwanted.find(c) != std::string_view::npos || static_cast<unsigned char>(c) < 0x20U;
      },
      '_');
  return text;
}

std::string toml_string(std::string_view text) {
  constexpr unsigned char kDelete = 0x7f;
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (code < 0x20 || code == kDelete) {
      out += fmt::format("\\u{:04X}", code);
    } else {
      out += c;
    }
  }
  return out + '"';
}

void tell(std::string_view text) noexcept {
  static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
}

void warn(std::string_view text) {
  tell(fmt::format("dampline: warning: {}\n", drivers::printable(text)));
}

std::size_t edit_distance(std::string_view left, std::string_view right) {
  std::vector<std::size_t> row(right.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < left.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < right.size(); ++j) {
      const std::size_t replaced = diagonal + (left[i] == right[j] ? 0U : 1U);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

std::string_view nearest(std::string_view word, std::span<const std::string_view> known) {
  std::string_view best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string_view candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

std::string list_words(std::span<const std::string_view> words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += '"';
    text += words[i];
    text += '"';
  }
  return text;
}

std::vector<std::string> parts_of_list(std::string_view text) {
  constexpr std::string_view kBetween = ", ";
  std::vector<std::string> out;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(kBetween), text.size()));
    if (text.empty()) return out;
    const std::string_view part = text.substr(0, text.find(','));
    out.emplace_back(part.substr(0, part.find_last_not_of(' ') + 1));
    text.remove_prefix(part.size());
  }
}

}  // namespace dampline::app

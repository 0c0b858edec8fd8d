// SPDX-License-Identifier: MIT
#include "app/text/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

}  // namespace dampline::app

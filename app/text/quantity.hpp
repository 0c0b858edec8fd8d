// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>

namespace dampline::app {

/// A value with as many digits as its standard deviation supports (two of the deviation), and the
/// deviation itself: {"8351", "14"}. With no usable deviation: six significant digits and "".
struct QuantityText {
  std::string value;
  std::string std;
};
[[nodiscard]] QuantityText format_quantity(double value, double std);

/// 1234567 as "1 234 567", with `separator` between the groups.
[[nodiscard]] std::string format_count(std::uint64_t count, const std::string& separator = " ");

/// Microseconds as "238 µs", above 10,000 as "12 ms".
[[nodiscard]] std::string format_microseconds(double us);

/// Seconds as "45 s", "12 min 30 s", "5 h 12 min".
[[nodiscard]] std::string format_duration(double seconds);

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dampline::app {

/// A value with as many digits as its standard deviation supports (two of the deviation), and the
/// deviation itself: {"8351", "14"}. With no usable deviation: six significant digits and "".
struct QuantityText {
  std::string value;
  std::string std;
};
[[nodiscard]] QuantityText format_quantity(double value, double std);

/// The unit in which people read a number, and the factor to it: mm for m, mm/s for m/s, MN/m and
/// kN s/m where N/m and N s/m would need many digits; any other unit stays.
struct ReadUnit {
  double factor{1.0};
  std::string name;
};
[[nodiscard]] ReadUnit read_unit(std::string_view unit, double value);
/// Value and deviation in that unit: "0.2954 ± 0.0037 mm".
[[nodiscard]] std::string quantity_text(double value, double std, std::string_view unit);

/// 1234567 as "1 234 567", with `separator` between the groups.
[[nodiscard]] std::string format_count(std::uint64_t count, const std::string& separator = " ");

/// Microseconds as "238 µs", above 10,000 as "12 ms".
[[nodiscard]] std::string format_microseconds(double us);

/// Seconds as "45 s", "12 min 30 s", "5 h 12 min".
[[nodiscard]] std::string format_duration(double seconds);

/// A table for a terminal: columns as wide as their widest cell, two blanks between them; empty
/// columns are left out.
[[nodiscard]] std::string columns_text(const std::vector<std::vector<std::string>>& rows);

/// Control characters and those of `unwanted` as '_'.
[[nodiscard]] std::string without(std::string text, std::string_view unwanted);

/// A TOML basic string: in quotes, with what must be escaped escaped.
[[nodiscard]] std::string toml_string(std::string_view text);

/// On the standard error. That it cannot be written is nobody's failure.
void tell(std::string_view text) noexcept;
/// Likewise, as a warning of the program.
void warn(std::string_view text);

/// Levenshtein distance: insertions, deletions and replacements of one character.
[[nodiscard]] std::size_t edit_distance(std::string_view left, std::string_view right);

/// The nearest of `known`; empty when `known` is.
[[nodiscard]] std::string_view nearest(std::string_view word,
                                       std::span<const std::string_view> known);

/// "a", "b" or "c", for messages that say what would have been accepted.
[[nodiscard]] std::string list_words(std::span<const std::string_view> words);

/// The parts of "a, b,c" without the spaces about them; empty ones are none.
[[nodiscard]] std::vector<std::string> parts_of_list(std::string_view text);

}  // namespace dampline::app

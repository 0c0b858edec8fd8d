// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dampline::drivers {

/// Takes the next cell off the front of a line: up to the separator, blanks and quotes cut off.
/// `more` is false when it was the last.
std::string_view take_cell(std::string_view& rest, char separator, bool& more) noexcept;

/// The separator that a header line uses: the most frequent of , ; and tab outside quotes; where
/// there is none of them, any number of blanks (' ').
char separator_of(std::string_view header) noexcept;

/// The names of a header line.
std::vector<std::string> cells_of(std::string_view header, char separator);

/// Reads a number: decimal or nan or inf in any case, with an optional +; an empty cell,
/// NA, null, none and - are NaN.
/// Where the separator is not a comma, a decimal comma is read as a point. False when it is
/// anything else.
bool read_number(std::string_view cell, char separator, double& number) noexcept;

/// A date and a time of day (ISO 8601), "2024-05-01T12:00:00.25Z", also with a blank for the T,
/// slashes, an offset from UTC or no zone, which is taken as UTC.
struct Stamp {
  std::int64_t utc_ns{0};  ///< since 1970
  bool zone_is_named{false};
};
[[nodiscard]] std::optional<Stamp> read_stamp(std::string_view cell) noexcept;

}  // namespace dampline::drivers

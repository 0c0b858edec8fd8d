// SPDX-License-Identifier: MIT
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace dampline::app {

/// The cells of one line of a table that this program wrote.
using Cells = std::vector<std::string_view>;

/// A cell's number. Throws RunError.
[[nodiscard]] double number(std::string_view cell);

/// Calls `row` with the cells of each line after the header; returns the header's cells. Throws
/// RunError naming `origin` and the line, also for what `row` throws.
std::vector<std::string> read_rows(std::string_view text, const std::string& origin,
                                   const std::function<void(const Cells&)>& row);

}  // namespace dampline::app

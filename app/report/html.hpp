// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace dampline::app {

/// Text safe to stand in an element or an attribute.
[[nodiscard]] std::string escape_html(std::string_view text);

/// Rows of escaped cells under a header. The first column is text; the `numbers` columns after it
/// are aligned to the right; what follows is text.
[[nodiscard]] std::string html_table(const std::vector<std::string>& header,
                                     const std::vector<std::vector<std::string>>& rows,
                                     std::size_t numbers);

}  // namespace dampline::app

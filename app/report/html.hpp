// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace dampline::app {

/// Text safe to stand in an element or an attribute.
[[nodiscard]] std::string escape_html(std::string_view text);

/// Rows of escaped cells under a header; lines of a cell end in '\n'. The first column is text; the
/// `numbers` columns after it are aligned to the right; what follows is text. Row i is grey where
/// `grey[i]`. On a phone a table of more than two columns is shown row by row, each cell behind the
/// name of its column. The first cell of row i leads to `links[i]`, where that is not empty.
[[nodiscard]] std::string html_table(const std::vector<std::string>& header,
                                     const std::vector<std::vector<std::string>>& rows,
                                     std::size_t numbers, const std::vector<bool>& grey = {},
                                     const std::vector<std::string>& links = {});

/// Folded away until somebody wants to see it; `body` is HTML.
[[nodiscard]] std::string html_details(std::string_view summary, const std::string& body);

}  // namespace dampline::app

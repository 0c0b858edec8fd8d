// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>

namespace dampline::app {

/// HTML of what the subjects print as Markdown: headings of three signs, tables, lists of hyphens,
/// paragraphs. A <figure> passes as it is.
[[nodiscard]] std::string html_of_markdown(std::string_view markdown);

/// A page that holds its style, under a heading.
[[nodiscard]] std::string whole_page(const std::string& heading, const std::string& body);

}  // namespace dampline::app

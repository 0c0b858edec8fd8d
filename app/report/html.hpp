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

inline constexpr std::string_view kPageStyle = R"css(
:root { color-scheme: light; }
body { font: 16px/1.5 Helvetica, Arial, "DejaVu Sans", sans-serif; color: #222; background: #fff;
       max-width: 60rem; margin: 2rem auto; padding: 0 1.2rem; }
h1 { font-size: 1.35rem; margin: 0; color: #555; font-weight: normal; }
h2 { font-size: 1.2rem; margin: 2.4rem 0 0.4rem; border-bottom: 1px solid #ddd; padding-bottom: 0.2rem; }
.lead { font-size: 1.35rem; line-height: 1.4; margin: 0.6rem 0 1.2rem; }
p.note, figcaption { color: #555; font-size: 0.92rem; }
.warning { background: #fff6e0; border-left: 4px solid #d98e00; padding: 0.5rem 0.9rem; margin: 0.6rem 0; }
figure { margin: 0.6rem 0; }
figure svg { width: 100%; height: auto; display: block; }
table { border-collapse: collapse; margin: 0.6rem 0; }
th, td { padding: 0.25rem 1rem 0.25rem 0; text-align: left; border-bottom: 1px solid #eee;
         vertical-align: top; overflow-wrap: anywhere; }
th { color: #555; font-weight: normal; border-bottom: 1px solid #bbb; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr.grey td { color: #888; }
ul { padding-left: 1.2rem; }
pre { background: #f6f6f6; padding: 0.8rem; overflow-x: auto; font-size: 0.82rem; line-height: 1.35; }
code { font-size: 0.9em; overflow-wrap: anywhere; }
)css";

}  // namespace dampline::app

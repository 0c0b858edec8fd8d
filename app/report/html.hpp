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

/// Colours have names, of which dark screens have other values; paper is light.
inline constexpr std::string_view kPageStyle = R"css(
:root { color-scheme: light dark; --page: #fff; --ink: #222; --soft: #555; --line: #ddd; --tint: #f4f4f4;
        --warn: #fff6e0; --mark: #b36b00;
        --blue: #0b5fa5; --orange: #b84a00; --green: #00694c; --pink: #a2417d; --grey: #6b6b6b; }
@media screen and (prefers-color-scheme: dark) {
  :root { --page: #161616; --ink: #e8e8e8; --soft: #b4b4b4; --line: #3c3c3c; --tint: #242424;
          --warn: #3a2e10; --mark: #e0a030;
          --blue: #6fb3f2; --orange: #ff9c5a; --green: #4fd1a5; --pink: #ee9ccb; --grey: #a4a4a4; }
}
body { font: 16px/1.5 Helvetica, Arial, "DejaVu Sans", sans-serif; color: var(--ink);
       background: var(--page); max-width: 60rem; margin: 2rem auto; padding: 0 1.2rem; }
h1 { font-size: 1.35rem; margin: 0; color: var(--soft); font-weight: normal; }
h2 { font-size: 1.2rem; margin: 2.4rem 0 0.4rem; border-bottom: 1px solid var(--line); padding-bottom: 0.2rem; }
.lead { font-size: 1.35rem; line-height: 1.4; margin: 0.6rem 0 1.2rem; }
p.note, figcaption { color: var(--soft); font-size: 0.92rem; }
.warning { background: var(--warn); border-left: 4px solid var(--mark); padding: 0.5rem 0.9rem; margin: 0.6rem 0; }
figure { margin: 0.6rem 0; break-inside: avoid; }
.panels { display: grid; gap: 0.4rem 1.2rem; grid-template-columns: minmax(0, 44rem); }
.panels.beside { grid-template-columns: repeat(auto-fit, minmax(min(100%, 20rem), 1fr)); }
.plot { width: 100%; height: auto; display: block; font-size: 14px; }
.plot text { fill: var(--ink); }
.plot .grid { stroke: var(--line); stroke-width: 0.8; }
.plot .axis { stroke: var(--grey); fill: none; }
.blue { color: var(--blue); } .orange { color: var(--orange); } .green { color: var(--green); }
.pink { color: var(--pink); } .grey { color: var(--grey); }
table { border-collapse: collapse; margin: 0.6rem 0; }
th, td { padding: 0.25rem 1rem 0.25rem 0; text-align: left; border-bottom: 1px solid var(--line);
         vertical-align: top; overflow-wrap: anywhere; }
th { color: var(--soft); font-weight: normal; border-bottom: 1px solid var(--grey); }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr.grey td { color: var(--grey); }
ul { padding-left: 1.2rem; }
pre { background: var(--tint); padding: 0.8rem; overflow-x: auto; font-size: 0.82rem; line-height: 1.35; }
code { font-size: 0.9em; overflow-wrap: anywhere; }
@media (max-width: 40rem) { body { padding: 0 0.8rem; } table { display: block; overflow-x: auto; } }
@media print { body { max-width: none; margin: 0; font-size: 11pt; } }
)css";

}  // namespace dampline::app

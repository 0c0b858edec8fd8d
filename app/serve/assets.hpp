// SPDX-License-Identifier: MIT
#pragma once
#include <string_view>

namespace dampline::app {

// The files in app/serve/page.
[[nodiscard]] std::string_view live_page();
[[nodiscard]] std::string_view live_style();  ///< beside page_style()
[[nodiscard]] std::string_view live_script();

}  // namespace dampline::app

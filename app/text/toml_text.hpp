// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>

namespace dampline::app {

/// A TOML basic string: in quotes, with what must be escaped escaped.
[[nodiscard]] std::string toml_string(std::string_view text);

}  // namespace dampline::app

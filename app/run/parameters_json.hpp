// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>

#include "app/run/result.hpp"

namespace dampline::app {

/// Everything of a result but its tables, as parameters.json holds it: valid JSON, a trailing
/// newline. A number that is not finite becomes null.
[[nodiscard]] std::string to_json(const RunResult& result);

/// The inverse. Throws RunError naming `origin` and the field that is missing or of a wrong kind.
[[nodiscard]] RunResult from_json(std::string_view text, const std::string& origin);

}  // namespace dampline::app

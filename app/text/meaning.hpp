// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>

namespace dampline::app {

/// What a parameter is, in a few plain words; empty for a name that is not known.
[[nodiscard]] std::string meaning_of_parameter(std::string_view name);

/// What a counter counts, in a few plain words; the name itself when it is not known.
[[nodiscard]] std::string meaning_of_count(std::string_view name);

}  // namespace dampline::app

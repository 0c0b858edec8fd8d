// SPDX-License-Identifier: MIT
#pragma once
#include <string_view>

namespace dampline::app {

/// On the standard error, as a warning of the program.
void warn(std::string_view text);

}  // namespace dampline::app

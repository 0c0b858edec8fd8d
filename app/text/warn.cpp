// SPDX-License-Identifier: MIT
#include "app/text/warn.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace dampline::app {

void warn(std::string_view text) { fmt::print(stderr, "dampline: warning: {}\n", text); }

}  // namespace dampline::app

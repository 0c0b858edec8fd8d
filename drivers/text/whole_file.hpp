// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <string>

#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// The content of a file that a person wrote. More than `most` bytes are none: a device or a pipe
/// that never ends is refused, too.
Outcome<std::string> read_whole(const std::string& path, std::size_t most);

}  // namespace dampline::drivers

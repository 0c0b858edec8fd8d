// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>

#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// Gives a file's bytes to `take`, part by part, until it returns false; returns how many there
/// were. A named pipe that nobody writes is empty.
Outcome<std::uint64_t> read_parts(const std::string& path,
                                  const std::function<bool(std::span<const char>)>& take);

/// The content of a file. More than `most` bytes are none: a device or a pipe that never ends is
/// refused, too.
Outcome<std::string> read_whole(const std::string& path,
                                std::size_t most = std::numeric_limits<std::size_t>::max());

}  // namespace dampline::drivers

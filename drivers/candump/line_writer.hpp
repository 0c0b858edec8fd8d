// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <cstddef>
#include <string_view>

#include "dampline/can_frame.hpp"

namespace dampline::drivers {

/// Appends one line as `candump -l` writes it: "(1700000000.000200) can0 310#0A1B2C00\n", also CAN
/// FD, remote requests and error frames. The interface's name is cut at 15 characters and set right
/// in `name_width`, as candump does with several interfaces. Times before 1970 are written as 0.
/// Not kept: the raw length code of a classic frame of 8 bytes.
void append_candump(fmt::memory_buffer& text, const CanFrame& frame,
                    std::string_view interface_name, std::size_t name_width = 0);

}  // namespace dampline::drivers

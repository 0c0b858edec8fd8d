// SPDX-License-Identifier: MIT
#pragma once
#include <linux/can.h>

#include <cstddef>

#include "dampline/can_frame.hpp"

namespace dampline::drivers {

/// A frame as the kernel hands it over, `bytes` long. False: no frame (wrong size or length). The
/// time is left alone.
[[nodiscard]] bool from_wire(const canfd_frame& wire, std::size_t bytes, CanFrame& frame) noexcept;

/// Returns how many bytes of `wire` to hand to the kernel; 0: no frame of this form exists.
[[nodiscard]] std::size_t to_wire(const CanFrame& frame, canfd_frame& wire) noexcept;

}  // namespace dampline::drivers

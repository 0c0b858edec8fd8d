// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "dampline/can_frame.hpp"
#include "hal/event.hpp"

namespace dampline::drivers {

/// What one error frame tells, in this order: bus-off, other errors, restart.
struct ErrorEvents {
  std::array<hal::Event, 3> events{};
  std::size_t count{0};
};
[[nodiscard]] ErrorEvents error_events(const CanFrame& frame) noexcept;

}  // namespace dampline::drivers

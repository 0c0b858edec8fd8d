// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "hal/clock.hpp"

namespace dampline::drivers {

/// The kernel's clocks.
class SystemClock final : public hal::Clock {
 private:
  [[nodiscard]] std::int64_t do_monotonic_ns() const noexcept override;
  [[nodiscard]] std::int64_t do_realtime_ns() const noexcept override;
  void do_sleep_until(std::int64_t monotonic_ns) const noexcept override;
};

}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#include "drivers/socketcan/error_frame.hpp"

#include <linux/can/error.h>

#include <cstdint>

namespace dampline::drivers {

ErrorEvents error_events(const CanFrame& frame) noexcept {
  ErrorEvents told;
  if (!frame.error) return told;
  const auto tell = [&](hal::EventKind kind, std::int64_t value) {
    told.events[told.count++] = {
        .time_ns = frame.time_ns, .kind = kind, .line = frame.interface_index, .value = value};
  };
  const std::uint32_t other = frame.id & ~(CAN_ERR_BUSOFF | CAN_ERR_RESTARTED);
  if ((frame.id & CAN_ERR_BUSOFF) != 0) tell(hal::EventKind::kBusOff, 0);
  if (other != 0) tell(hal::EventKind::kBusError, other);
  if ((frame.id & CAN_ERR_RESTARTED) != 0) tell(hal::EventKind::kBusRestarted, 0);
  return told;
}

}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#include "drivers/socketcan/frame_filter.hpp"

#include <algorithm>

namespace dampline::drivers {

std::vector<can_filter> make_filters(std::span<const Identifier> identifiers) {
  std::vector<can_filter> filters;
  filters.reserve(identifiers.size());
  for (const Identifier& wanted : identifiers) {
    const std::uint32_t bits = wanted.extended ? CAN_EFF_MASK : CAN_SFF_MASK;
    const std::uint32_t format = wanted.extended ? CAN_EFF_FLAG : 0U;
    filters.push_back(
        {.can_id = (wanted.id & bits) | format, .can_mask = bits | CAN_EFF_FLAG | CAN_RTR_FLAG});
  }
  const auto less = [](const can_filter& a, const can_filter& b) { return a.can_id < b.can_id; };
  const auto same = [](const can_filter& a, const can_filter& b) { return a.can_id == b.can_id; };
  std::sort(filters.begin(), filters.end(), less);
  filters.erase(std::unique(filters.begin(), filters.end(), same), filters.end());
  return filters;
}

}  // namespace dampline::drivers

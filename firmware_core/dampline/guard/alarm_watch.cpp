// SPDX-License-Identifier: MIT
#include "dampline/guard/alarm_watch.hpp"

#include <algorithm>

namespace dampline {

void AlarmWatch::take(const BlockReport& block, std::int64_t tick, Estimator& estimator) noexcept {
  const bool has_rows = block.status == BlockStatus::kUsed || block.status == BlockStatus::kPartial;
  if (!active_ || !has_rows || ++blocks_ < meter_.due()) return;
  estimator.export_total(total_);
  blocks_ = total_.blocks;
  GroupMeter::Group group;
  const std::int64_t start = group_start_;
  const bool measured = meter_.update(total_, group);
  group_start_ = tick;
  if (!measured) return;
  ChangeAlarm alarm;
  const bool alarmed = watch_.update(group.friction_mps2, group.stiffness_ps2, alarm);
  start_tick_[static_cast<std::size_t>(watch_.groups()) % kGroups] = start;
  if (!alarmed) return;
  const std::int64_t first =
      std::max(alarm.first_group, watch_.groups() - static_cast<std::int64_t>(kGroups) + 1);
  view_.alarms[view_.count++ % AlarmView::kMost] = {
      alarm.parameter, alarm.change, start_tick_[static_cast<std::size_t>(first) % kGroups], tick};
}

}  // namespace dampline

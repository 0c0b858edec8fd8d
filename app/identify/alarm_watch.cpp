// SPDX-License-Identifier: MIT
#include "app/identify/alarm_watch.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dampline::app {

AlarmWatch::AlarmWatch(const EstimatorConfig& config)
    : active_{config.memory == Memory::kInfinite}, total_{std::make_unique<ScaleFactors>()} {}

void AlarmWatch::take(const BlockReport& block, std::int64_t tick, Estimator& identifier) noexcept {
  const bool has_rows = block.status == BlockStatus::kUsed || block.status == BlockStatus::kPartial;
  if (!active_ || !has_rows || ++blocks_ < meter_.due()) return;
  identifier.export_total(*total_);
  blocks_ = total_->blocks;
  GroupMeter::Group group;
  const std::int64_t start = group_start_;
  const bool measured = meter_.update(*total_, group);
  group_start_ = tick;
  if (!measured) return;
  ChangeAlarm alarm;
  const bool told = watch_.update(group.friction_mps2, group.stiffness_ps2, alarm);
  start_tick_[static_cast<std::size_t>(watch_.groups()) % kGroups] = start;
  if (!told) return;
  const std::int64_t first =
      std::max(alarm.first_group, watch_.groups() - static_cast<std::int64_t>(kGroups) + 1);
  view_.alarms[view_.count++ % AlarmView::kMost] = {
      alarm.parameter, alarm.change, start_tick_[static_cast<std::size_t>(first) % kGroups], tick};
}

void describe_alarms(const AlarmView& view, const TruckRecord& record, RunResult& result) {
  const std::uint64_t held = std::min<std::uint64_t>(view.count, AlarmView::kMost);
  for (std::uint64_t i = view.count - held; i < view.count; ++i) {
    const AlarmView::Alarm& alarm = view.alarms[i % AlarmView::kMost];
    const AlarmFinding finding{name_of(alarm.parameter), 100.0 * alarm.change,
                               record.time_s(alarm.since_tick), record.time_s(alarm.tick)};
    result.faults.alarms.push_back(finding);
    result.warnings.push_back(
        fmt::format("Alarm: {} ({}).", describe_alarm(finding), describe_alarm_figures()));
  }
}

}  // namespace dampline::app

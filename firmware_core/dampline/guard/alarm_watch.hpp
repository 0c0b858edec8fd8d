// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/damping/estimator.hpp"
#include "dampline/faults.hpp"
#include "dampline/guard/parameter_drift.hpp"

namespace dampline {

/// The live alarm beside an estimate: a minute of motion makes a group. Needs sums that forget
/// nothing, so with another memory it stays silent.
class AlarmWatch {
 public:
  explicit AlarmWatch(const EstimatorConfig& config) noexcept
      : active_{config.memory == Memory::kInfinite} {}
  /// After each block that the estimator has closed; `tick` is now.
  void take(const BlockReport& block, std::int64_t tick, Estimator& estimator) noexcept;
  [[nodiscard]] const AlarmView& view() const noexcept { return view_; }

 private:
  static constexpr std::size_t kGroups = 64;
  bool active_;
  std::uint32_t blocks_{0};
  ScaleFactors total_;
  GroupMeter meter_;
  ChangeWatch watch_;
  std::array<std::int64_t, kGroups> start_tick_{};  // of the newest groups
  std::int64_t group_start_{0};
  AlarmView view_;
};

}  // namespace dampline

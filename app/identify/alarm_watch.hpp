// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <memory>

#include "app/identify/truck_result.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/guard/parameter_drift.hpp"

namespace dampline::app {

/// The newest alarms, in the core's own time. Plain: it is handed between threads.
struct AlarmView {
  static constexpr std::size_t kMost = 8;
  struct Alarm {
    DriftingParameter parameter{};
    double change{0.0};
    std::int64_t since_tick{0};  ///< the first block that had changed
    std::int64_t tick{0};        ///< when it was told
  };
  std::array<Alarm, kMost> alarms{};
  std::uint64_t count{0};  ///< ever
};

/// To the result, in the record's own time, with a warning for each.
void describe_alarms(const AlarmView& view, const TruckRecord& record, RunResult& result);

/// The live alarm beside an identification: a minute of motion makes a group. Needs sums that
/// forget nothing, so with another memory it stays silent. Nothing here allocates after
/// construction.
class AlarmWatch {
 public:
  explicit AlarmWatch(const EstimatorConfig& config);
  /// After each block that the identifier has closed; `tick` is now.
  void take(const BlockReport& block, std::int64_t tick, Estimator& identifier) noexcept;
  [[nodiscard]] const AlarmView& view() const noexcept { return view_; }

 private:
  static constexpr std::size_t kGroups = 64;
  bool active_;
  std::uint32_t blocks_{0};
  std::unique_ptr<ScaleFactors> total_;
  GroupMeter meter_;
  ChangeWatch watch_;
  std::array<std::int64_t, kGroups> start_tick_{};  // of the newest groups
  std::int64_t group_start_{0};
  AlarmView view_;
};

}  // namespace dampline::app

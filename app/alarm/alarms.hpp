// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/run/result.hpp"
#include "hal/event.hpp"

namespace dampline::app {

/// An alarm that was raised or went.
struct AlarmChange {
  WatchState watch;
  std::uint8_t number{0};  ///< among those of the configuration, in their order
  [[nodiscard]] hal::EventKind kind() const noexcept {
    return watch.active ? hal::EventKind::kAlarmRaised : hal::EventKind::kAlarmCleared;
  }
};

/// The alarms of [alarm] over the results of one run. A level is beyond its limit when its value
/// is, by more than one standard deviation; it is back when it is inside by the hysteresis. Either
/// must last for the hold time. A fault lasts until the hold time after it was last seen.
class Alarms {
 public:
  /// Throws UsageError naming the key, what was found and what was expected.
  explicit Alarms(const AlarmSettings& settings);

  /// What changed with this result. Results come in the order of their time.
  [[nodiscard]] std::vector<AlarmChange> look(const RunResult& result);
  /// All of them, for live.json and the metrics.
  [[nodiscard]] std::vector<WatchState> states() const;
  [[nodiscard]] bool any_raised() const noexcept;
  [[nodiscard]] bool empty() const noexcept { return rules_.empty(); }

 private:
  enum class Kind : std::uint8_t { kBelow, kAbove, kDrift, kFault };
  struct Rule {
    Kind kind;
    std::string fault;  ///< of kFault: its name, or "all"
    WatchState state;
    std::optional<double> pending_s;  ///< since when the other state is what is seen
  };
  void add_level(const char* name, Kind kind, double limit_n);
  void add_reference(const AlarmSettings& settings);
  /// Whether the rule's cause is there; absent: nothing is known.
  [[nodiscard]] std::optional<bool> seen(Rule& rule, const RunResult& result) const;
  [[nodiscard]] std::optional<bool> level_seen(Rule& rule, const RunResult& result) const;

  double hold_s_;
  double hysteresis_;  ///< share of a limit
  std::vector<Rule> rules_;
};

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>

#include "app/live/process.hpp"
#include "app/verbs/simulate.hpp"
#include "hal/clock.hpp"

namespace dampline::app {

/// Throws UsageError where the options for sending do not fit each other or the rest.
void check_sending(const SimulateOptions& options);

/// Simulates and sends the frames on `options.to`, each sample instant when it is due. Ends early
/// at SIGINT or SIGTERM. An interface that is down or away does not end it: frames that could not
/// be sent are counted. Throws RunError where the interface cannot be opened.
void send_run(const SimulateOptions& options, const SimulatedRun& run);

/// When frames are due: at their distance from the first, divided by `speed`, on the monotonic
/// clock. Each moment is reckoned from the first, so lateness does not add up.
class FrameSchedule {
 public:
  /// `speed` 0: always at once.
  FrameSchedule(const hal::Clock& clock, double speed) noexcept : clock_{clock}, speed_{speed} {}
  /// `first_ns`: the time of the first frame of all, which is due at the first call.
  void start(std::int64_t first_ns) noexcept;
  /// The monotonic time at which a frame of this time is due.
  [[nodiscard]] std::int64_t due_ns(std::int64_t time_ns) const noexcept;
  /// Sleeps until then. False: an end was asked for.
  [[nodiscard]] bool wait_for(std::int64_t time_ns, const StopRequest& stop) const noexcept;

 private:
  const hal::Clock& clock_;
  double speed_;
  bool started_{false};
  std::int64_t first_ns_{0};
  std::int64_t start_ns_{0};
};

}  // namespace dampline::app

// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "dampline/can_frame.hpp"
#include "hal/clock.hpp"

namespace dampline::drivers {

/// By how much the wall clock was set since the run began. Wall clock and monotonic clock are
/// slewed together, so their difference changes by steps alone.
class ClockSteps {
 public:
  /// A smaller change is taken for the noise of reading two clocks; several add up until they pass.
  static constexpr std::int64_t kLeastStepNs = 1'000'000;

  explicit ClockSteps(hal::RunTime run_time) noexcept : run_time_{run_time} {}
  /// The step since the last check, in whole microseconds, or 0. Reads each clock once, and again
  /// only where the difference has changed.
  [[nodiscard]] std::int64_t check(const hal::Clock& clock) noexcept;
  /// All steps so far: wall clock = run time + this.
  [[nodiscard]] std::int64_t total_ns() const noexcept { return total_ns_; }
  /// Run time at the last check.
  [[nodiscard]] std::int64_t checked_at_ns() const noexcept { return checked_at_ns_; }

 private:
  hal::RunTime run_time_;
  std::int64_t total_ns_{0};
  std::int64_t checked_at_ns_{0};
};

/// The kernel's stamps of one frame; 0 where there is none.
struct FrameStamp {
  std::int64_t software_ns{0};  ///< wall clock
  std::int64_t hardware_ns{0};  ///< the controller's own clock
};

/// From stamps to run time, never decreasing, in whole microseconds: as many digits as a candump
/// log has.
///
/// Software stamps are wall-clock times, from which the wall clock's steps are taken. A frame may
/// have been stamped before a step and be read after it, so until the queue has been empty once,
/// the time before the step is tried as well: the true time lies between the newest frame and now.
/// Hardware stamps are tied to run time at the first frame; the tie follows the software stamps by
/// a 1024th of the distance with each frame, and jumps where they are more than 50 ms apart.
class FrameTime {
 public:
  FrameTime(hal::RunTime run_time, bool hardware) noexcept
      : steps_{run_time}, hardware_{hardware} {}

  /// Call once behind each batch, before its frames are stamped. Returns the step of the wall clock
  /// since the last call, or 0. `drained`: nothing was left in the queue behind this batch.
  std::int64_t begin_batch(const hal::Clock& clock, bool drained) noexcept;
  /// Sets time and time source.
  void stamp(const FrameStamp& stamp, CanFrame& frame) noexcept;

  [[nodiscard]] std::uint64_t reordered() const noexcept { return reordered_; }
  [[nodiscard]] std::int64_t newest_ns() const noexcept { return newest_ns_; }

 private:
  [[nodiscard]] std::int64_t software_time_ns(std::int64_t stamp_ns) noexcept;
  [[nodiscard]] std::int64_t hardware_time_ns(std::int64_t stamp_ns,
                                              std::int64_t software_ns) noexcept;
  [[nodiscard]] std::int64_t distance_ns(std::int64_t time_ns) const noexcept;

  ClockSteps steps_;
  bool hardware_;
  bool drained_{false};               // the last batch emptied the queue
  bool step_pending_{false};          // frames from before the last step may still come
  bool step_is_new_{false};           // it was found behind the last batch
  std::int64_t before_ns_{0};         // all steps without the last
  std::int64_t earliest_ns_{0};       // no frame that is still to come is older
  std::int64_t next_earliest_ns_{0};  // the same for the next batch
  std::int64_t newest_ns_{0};
  bool tied_{false};
  std::int64_t tie_ns_{0};  // run time minus the controller's clock
  std::uint64_t reordered_{0};
};

}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "app/live/acquisition.hpp"
#include "app/live/condition.hpp"
#include "hal/record_sink.hpp"

namespace dampline::app {

/// Watches the acquisition's counters from the main thread and knows since when what did not move.
class Monitor {
 public:
  Monitor(const Acquisition& acquisition, std::int64_t monotonic_ns)
      : acquisition_{acquisition}, sample_ns_{monotonic_ns} {}

  /// Call some times a second.
  Condition look(const hal::RecordHealth& record, std::int64_t monotonic_ns) noexcept {
    note(acquisition_.samples(), samples_, sample_ns_, monotonic_ns);
    note(acquisition_.frames_dropped() + acquisition_.items().lost() + record.lost, losses_,
         loss_ns_, monotonic_ns);
    return {.any_sample = samples_ > 0,
            .link_up = acquisition_.link_up(),
            .recording = record.recording,
            .lost_lately = losses_ > 0 && monotonic_ns - loss_ns_ < kLatelyNs,
            .silence_ns = monotonic_ns - sample_ns_};
  }

 private:
  static void note(std::uint64_t now, std::uint64_t& known, std::int64_t& since_ns,
                   std::int64_t monotonic_ns) noexcept {
    if (now == known) return;
    known = now;
    since_ns = monotonic_ns;
  }
  const Acquisition& acquisition_;
  std::uint64_t samples_{0};
  std::uint64_t losses_{0};
  std::int64_t sample_ns_;
  std::int64_t loss_ns_{0};
};

}  // namespace dampline::app

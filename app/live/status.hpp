// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "app/config/config.hpp"
#include "app/live/acquisition.hpp"
#include "app/live/process.hpp"
#include "app/run/result.hpp"
#include "hal/record_sink.hpp"

namespace dampline::app {

/// What the status lamp, the service manager and live.json tell.
enum class LiveState : std::uint8_t {
  kWaiting,      ///< no sample came yet
  kIdentifying,  ///< samples come and are recorded
  kDegraded,     ///< samples come or were missing for seconds only; something is lost
  kFault,        ///< nothing can be identified: no link, or no sample for kFaultNs
};

/// How things stand, seen from the main thread.
struct Condition {
  bool any_sample{false};
  bool link_up{true};
  bool recording{true};        ///< or not wanted
  bool lost_lately{false};     ///< frames or records, within kLatelyNs
  std::int64_t silence_ns{0};  ///< since the newest sample
};

inline constexpr std::int64_t kSilenceNs = 1'000'000'000;
inline constexpr std::int64_t kFaultNs = 10'000'000'000;
inline constexpr std::int64_t kLatelyNs = 10'000'000'000;

[[nodiscard]] constexpr LiveState judge(const Condition& c) noexcept {
  if (!c.link_up || c.silence_ns > kFaultNs) return LiveState::kFault;
  if (!c.any_sample) return LiveState::kWaiting;
  if (c.silence_ns > kSilenceNs || !c.recording || c.lost_lately) return LiveState::kDegraded;
  return LiveState::kIdentifying;
}

[[nodiscard]] constexpr std::string_view name_of(LiveState state) noexcept {
  switch (state) {
    case LiveState::kWaiting:
      return "waiting";
    case LiveState::kIdentifying:
      return "identifying";
    case LiveState::kDegraded:
      return "degraded";
    case LiveState::kFault:
      return "fault";
  }
  return "";
}

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

/// What surrounds a status: all that live.json and the report tell of a live run.
struct LiveSurroundings {
  std::string source;  ///< "can0"
  Realtime realtime;
  hal::RecordHealth record;
  bool record_wanted{true};
  std::string state;
  std::int64_t start_ns{0};  ///< monotonic
  std::int64_t silence_ns{0};
  std::uint64_t publish_failures{0};
};

/// The live figures and what a reader must know of them; adds to a result of whatever kind.
void describe_live(const LiveStatus& status, const LiveSurroundings& around, RunResult& result);

/// What the first estimate needs, and what of it is there.
[[nodiscard]] Collecting collecting_of(double elapsed_s, std::uint64_t usable_blocks,
                                       const Config& config) noexcept;

/// The law as far as it is known by now; `source` is what messages call it. Never throws for too
/// little data: then it says how much is there.
[[nodiscard]] RunResult result_so_far(const LiveStatus& status, const Config& config,
                                      const std::string& source);

/// A result in the middle of a live run: the law, counts, figures.
[[nodiscard]] RunResult live_result(const LiveStatus& status, const LiveSurroundings& around,
                                    const Config& config);

/// One line for a terminal or the service manager.
[[nodiscard]] std::string status_line(const RunResult& result);

}  // namespace dampline::app

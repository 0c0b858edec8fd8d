// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string_view>

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

}  // namespace dampline::app

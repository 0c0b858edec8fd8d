// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

#include "hal/clock.hpp"
#include "hal/frame_source.hpp"

namespace dampline::drivers {

/// time + step, both >= 0, where a record holds the times between frames; at most the last time
/// that fits.
[[nodiscard]] constexpr std::int64_t later(std::int64_t time_ns, std::int64_t step_ns) noexcept {
  return time_ns + std::min(step_ns, std::numeric_limits<std::int64_t>::max() - time_ns);
}

/// Times of a recording as frames must have them: one that goes back by less than a second is held
/// and counted as reordered, one that goes back by more is refused.
class TimeGate {
 public:
  [[nodiscard]] bool pass(std::int64_t& time_ns, hal::SourceHealth& health) noexcept {
    if (any_ && time_ns < newest_ns_) {
      if (newest_ns_ - time_ns >= hal::kSecondNs) return false;
      ++health.reordered;
      time_ns = newest_ns_;
    }
    any_ = true;
    newest_ns_ = time_ns;
    return true;
  }

 private:
  bool any_{false};
  std::int64_t newest_ns_{0};
};

}  // namespace dampline::drivers

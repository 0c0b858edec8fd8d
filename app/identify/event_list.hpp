// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "app/run/result.hpp"
#include "hal/event.hpp"

namespace dampline::app {

/// "link_down", "marker_on", ...
[[nodiscard]] std::string_view name_of(hal::EventKind kind) noexcept;

/// The first kMost events of a run; later ones are counted.
class EventList {
 public:
  static constexpr std::size_t kMost = 10000;
  void add(const hal::Event& event) {
    if (events_.size() < kMost) {
      events_.push_back(event);
    } else {
      ++more_;
    }
  }
  /// With times from the run's first sample, in the order of time.
  void describe(std::int64_t first_time_ns, RunResult& result) const;

 private:
  std::vector<hal::Event> events_;
  std::uint64_t more_{0};
};

}  // namespace dampline::app

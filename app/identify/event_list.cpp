// SPDX-License-Identifier: MIT
#include "app/identify/event_list.hpp"

#include <algorithm>
#include <array>

namespace dampline::app {
namespace {

/// By the number of the kind; the black box's format fixes the numbers.
constexpr std::array<std::string_view, 24> kEventNames{
    "unknown",           "run_start",         "run_end",         "link_down",     "link_up",
    "interface_removed", "interface_back",    "bus_off",         "bus_restarted", "bus_error",
    "frames_dropped",    "clock_step",        "signal_lost",     "signal_back",   "records_lost",
    "recording_stopped", "recording_resumed", "file_rotated",    "pulse",         "marker_on",
    "marker_off",        "wheel_pulse",       "impossible_edge", "edges_lost"};

}  // namespace

std::string_view name_of(hal::EventKind kind) noexcept {
  const auto number = static_cast<std::size_t>(kind);
  return number < kEventNames.size() ? kEventNames[number] : kEventNames[0];
}

void EventList::describe(std::int64_t first_time_ns, RunResult& result) const {
  std::vector<hal::Event> sorted = events_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const hal::Event& a, const hal::Event& b) { return a.time_ns < b.time_ns; });
  for (const hal::Event& event : sorted)
    result.events.push_back({1e-9 * static_cast<double>(event.time_ns - first_time_ns),
                             std::string{name_of(event.kind)}, event.line, event.value});
  result.events_more = more_;
}

}  // namespace dampline::app

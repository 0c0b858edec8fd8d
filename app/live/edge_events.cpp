// SPDX-License-Identifier: MIT
#include "app/live/edge_events.hpp"

#include <cstdlib>

namespace dampline::app {

EdgeEvents::EdgeEvents(const std::vector<LineKind>& kinds) {
  lines_.reserve(kinds.size());
  for (const LineKind kind : kinds) lines_.push_back({.kind = kind});
}

std::span<const hal::Event> EdgeEvents::take(const hal::Edge& edge) noexcept {
  used_ = 0;
  if (edge.line >= lines_.size()) return {};
  if (edge.lost_before > 0) {
    counts_.lost += edge.lost_before;
    add(edge, hal::EventKind::kEdgesLost, edge.lost_before);
  }
  if (edge.impossible) {
    ++counts_.impossible;
    add(edge, hal::EventKind::kImpossibleEdge, edge.rising ? 1 : -1);
  }
  add_meaning(lines_[edge.line], edge);
  return {events_.data(), used_};
}

void EdgeEvents::add(const hal::Edge& edge, hal::EventKind kind, std::int64_t value) noexcept {
  events_[used_] = {.time_ns = edge.time_ns, .kind = kind, .line = edge.line, .value = value};
  ++used_;
}

void EdgeEvents::add_meaning(Line& line, const hal::Edge& edge) noexcept {
  if (line.kind == LineKind::kMarker) {
    ++counts_.markers;
    add(edge, edge.rising ? hal::EventKind::kMarkerOn : hal::EventKind::kMarkerOff, 0);
    return;
  }
  if (!edge.rising) return;  // the end of a pulse tells nothing
  if (line.kind == LineKind::kWheel) {
    ++counts_.wheel_pulses;
    add(edge, hal::EventKind::kWheelPulse, 0);
    return;
  }
  ++counts_.pulses;
  judge_pulse(line, edge);
  add(edge, hal::EventKind::kPulse, 0);
}

void EdgeEvents::judge_pulse(Line& line, const hal::Edge& edge) noexcept {
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  const std::int64_t error_ns = edge.time_ns - line.pulse_ns - kSecondNs;
  if (line.pulsed && std::abs(error_ns) > kPulseToleranceNs) ++counts_.implausible;
  line.pulsed = true;
  line.pulse_ns = edge.time_ns;
}

}  // namespace dampline::app

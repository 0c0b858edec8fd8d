// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hal/edge_source.hpp"
#include "hal/event.hpp"

namespace dampline::app {

/// What a GPIO line tells.
enum class LineKind : std::uint8_t {
  kPulsePerSecond,  ///< a rising edge every second
  kMarker,          ///< active while a measurement goes on
  kWheel,           ///< a rising edge every revolution
};

/// Monotone.
struct EdgeCounts {
  std::uint64_t pulses{0};
  std::uint64_t markers{0};  ///< switched on or off
  std::uint64_t wheel_pulses{0};
  std::uint64_t impossible{0};   ///< a second edge of one direction in a row
  std::uint64_t implausible{0};  ///< a pulse per second that was not 1 s after the one before
  std::uint64_t lost{0};         ///< known to be lost
};

/// Makes events of edges. Every edge that tells something becomes its event, an impossible one too:
/// the event before it says that the one in between is missing.
class EdgeEvents {
 public:
  /// How far a pulse may be off by the clock that stamps the frames.
  static constexpr std::int64_t kPulseToleranceNs = 1'000'000;
  static constexpr std::size_t kMostEvents = 3;  ///< of one edge

  /// One kind for each line of the source, in its order.
  explicit EdgeEvents(const std::vector<LineKind>& kinds);
  /// The events of one edge, in their order. The view is good until the next call. A line that was
  /// not declared gives none.
  [[nodiscard]] std::span<const hal::Event> take(const hal::Edge& edge) noexcept;
  [[nodiscard]] const EdgeCounts& counts() const noexcept { return counts_; }

 private:
  struct Line {
    LineKind kind{LineKind::kPulsePerSecond};
    bool pulsed{false};
    std::int64_t pulse_ns{0};
  };
  void add(const hal::Edge& edge, hal::EventKind kind, std::int64_t value) noexcept;
  void add_meaning(Line& line, const hal::Edge& edge) noexcept;
  void judge_pulse(Line& line, const hal::Edge& edge) noexcept;

  std::vector<Line> lines_;
  std::array<hal::Event, kMostEvents> events_{};
  std::size_t used_{0};
  EdgeCounts counts_;
};

}  // namespace dampline::app

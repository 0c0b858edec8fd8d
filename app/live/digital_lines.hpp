// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "app/config/config.hpp"
#include "app/live/recorder.hpp"
#include "hal/clock.hpp"
#include "hal/digital_output.hpp"
#include "hal/edge_source.hpp"
#include "hal/event.hpp"

namespace dampline::app {

enum class LiveState : std::uint8_t;

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

enum class LampState : std::uint8_t { kOff, kIdentifying, kDegraded, kFault, kAlarm };

/// Whether the lamp is lit at that moment, so that a person tells the states apart at a glance:
///   identifying  steady
///   degraded     slow: 1 s on, 1 s off
///   fault        quick: four times a second
///   alarm        lit, with two short breaks every two seconds
/// A lamp that is dark for more than a second says that the program does not run.
[[nodiscard]] constexpr bool lamp_lit(LampState state, std::int64_t monotonic_ns) noexcept {
  constexpr std::int64_t kSlowHalfNs = 1'000'000'000;
  constexpr std::int64_t kQuickHalfNs = 125'000'000;
  constexpr std::int64_t kBreakNs = 250'000'000;
  switch (state) {
    case LampState::kOff:
      return false;
    case LampState::kIdentifying:
      return true;
    case LampState::kDegraded:
      return monotonic_ns / kSlowHalfNs % 2 == 0;
    case LampState::kFault:
      return monotonic_ns / kQuickHalfNs % 2 == 0;
    case LampState::kAlarm:
      return monotonic_ns / kBreakNs % 8 != 5 && monotonic_ns / kBreakNs % 8 != 7;
  }
  return false;
}

/// Drives the lamp, and only when it has to change. A lamp that fails is tried again once a second:
/// it never stops the run.
class StatusLamp {
 public:
  /// Null: there is no lamp, and nothing is done.
  explicit StatusLamp(std::unique_ptr<hal::DigitalOutput> output) noexcept;
  StatusLamp(const StatusLamp&) = delete;
  StatusLamp& operator=(const StatusLamp&) = delete;
  ~StatusLamp();  ///< switches it off
  /// Call some times a second; every 60 ms or more often keeps the quick pattern even.
  void show(LampState state, std::int64_t monotonic_ns) noexcept;
  [[nodiscard]] std::uint64_t failures() const noexcept { return failures_; }

 private:
  std::unique_ptr<hal::DigitalOutput> output_;
  std::optional<bool> lit_;  // absent: not known
  std::int64_t retry_ns_{0};
  std::uint64_t failures_{0};
};

/// One line as [gpio] names it: "marker:4:active_low".
struct LineSetting {
  LineKind kind{LineKind::kPulsePerSecond};
  unsigned offset{0};
  bool active_low{false};
};
/// Of [gpio] edges. Throws UsageError naming the key, what was found and what was expected.
[[nodiscard]] LineSetting parse_edge_line(const std::string& text);
/// Of [gpio] lamp: "7" or "7:active_low".
[[nodiscard]] LineSetting parse_lamp_line(const std::string& text);

/// The digital lines of a live run: a thread that makes events of edges, and the status lamp.
/// Without a chip in the configuration it does nothing.
class DigitalLines {
 public:
  /// Throws UsageError for a wrong setting, RunError when a line cannot be had.
  DigitalLines(const GpioConfig& config, const hal::RunTime& run_time);
  DigitalLines(const DigitalLines&) = delete;
  DigitalLines& operator=(const DigitalLines&) = delete;
  ~DigitalLines() { stop(); }

  /// From now on edges become events of `recorder`, which must live until stop().
  void start(Recorder& recorder);
  void stop();
  /// `alarm`: shown while the run itself is well.
  void show(LiveState state, bool alarm, std::int64_t monotonic_ns) noexcept;
  /// Adds counts and warnings. After stop().
  void describe(RunResult& result) const;

 private:
  void open_lines(const GpioConfig& config, const hal::RunTime& run_time);
  void watch(Recorder& recorder);
  void gone() noexcept { gone_ = true; }

  std::unique_ptr<hal::EdgeSource> edges_;
  std::unique_ptr<EdgeEvents> events_;
  std::unique_ptr<StatusLamp> lamp_;
  bool gone_{false};  // the thread's, until stop()
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace dampline::app

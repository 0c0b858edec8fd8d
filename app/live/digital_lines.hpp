// SPDX-License-Identifier: MIT
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "app/config/config.hpp"
#include "app/live/condition.hpp"
#include "app/live/edge_events.hpp"
#include "app/live/lamp.hpp"
#include "app/live/recorder.hpp"
#include "hal/clock.hpp"
#include "hal/edge_source.hpp"

namespace dampline::app {

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
  void show(LiveState state, std::int64_t monotonic_ns) noexcept;
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

// SPDX-License-Identifier: MIT
#pragma once
#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>

#include "app/live/handover.hpp"
#include "app/record/frames.hpp"
#include "hal/clock.hpp"
#include "hal/record_sink.hpp"

namespace dampline::app {

/// Where a run that keeps no black box writes its frames.
class VoidSink final : public hal::RecordSink {
 private:
  void do_write(const CanFrame& /*frame*/) noexcept override {}
  void do_write(const hal::Event& /*event*/) noexcept override {}
  void do_tick(std::int64_t /*monotonic_ns*/) noexcept override {}
  void do_rotate() noexcept override {}
  void do_close() noexcept override {}
  [[nodiscard]] hal::RecordHealth do_health() const noexcept override { return {}; }
};

/// The writer's thread: empties the rings of the acquisition and of the edges into the black box,
/// and keeps the list of events. A slow disk delays only this thread.
class Recorder {
 public:
  Recorder(hal::RecordSink& sink, const hal::Clock& clock, RecordQueue& items)
      : sink_{sink}, clock_{clock}, items_{items} {}
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  ~Recorder() { stop(); }

  void start();
  /// Writes what the rings hold, closes the sink and ends the thread. The second time: nothing.
  void stop();
  /// Ends the current file of the black box soon.
  void rotate() noexcept { rotate_.store(true, std::memory_order_release); }
  /// Another source of events, any thread.
  void add(const hal::Event& event);
  [[nodiscard]] hal::RecordHealth health() const;
  /// While it runs: the newest events but pulses. Any thread.
  [[nodiscard]] EventList newest_events() const;
  /// After stop().
  [[nodiscard]] const EventList& events() const noexcept { return events_; }

 private:
  void loop() noexcept;
  void turn() noexcept;
  void take_others() noexcept;
  void take_lost() noexcept;
  void keep(const hal::Event& event) noexcept;

  hal::RecordSink& sink_;
  const hal::Clock& clock_;
  RecordQueue& items_;
  std::uint64_t known_lost_{0};
  std::int64_t newest_ns_{0};  // run time of the newest item
  EventList events_;
  std::deque<hal::Event> newest_;  // under health_mutex_
  std::mutex others_mutex_;        // of what comes from other threads than the acquisition
  std::vector<hal::Event> others_;
  mutable std::mutex health_mutex_;
  hal::RecordHealth health_;
  std::atomic<bool> rotate_{false};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace dampline::app

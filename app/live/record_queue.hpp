// SPDX-License-Identifier: MIT
#pragma once
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "app/live/spsc_ring.hpp"
#include "app/live/wake_call.hpp"
#include "dampline/can_frame.hpp"
#include "hal/event.hpp"

namespace dampline::app {

/// What goes from the acquisition to the writer: a frame or an event, in the order in which they
/// happened.
struct RecordItem {
  bool is_event{false};
  CanFrame frame{};
  hal::Event event{};
};

/// The way from the acquisition to the writer, who comes by from time to time and is called when a
/// quarter of the room is taken. push() never waits; it counts what found no room.
class RecordQueue {
 public:
  explicit RecordQueue(std::size_t least) : ring_{least} {}

  // The acquisition's side.
  void push(const RecordItem& item) noexcept {
    if (!ring_.push(item)) lost_.fetch_add(1, std::memory_order_release);
    if (++since_call_ < ring_.capacity() / 4) return;
    since_call_ = 0;
    call_.call();
  }
  // The writer's side.
  [[nodiscard]] bool pop(RecordItem& item) noexcept { return ring_.pop(item); }
  void wait(std::chrono::nanoseconds most) noexcept { call_.wait(most); }
  // Anybody's.
  [[nodiscard]] std::uint64_t lost() const noexcept {
    return lost_.load(std::memory_order_acquire);
  }

 private:
  SpscRing<RecordItem> ring_;
  std::size_t since_call_{0};
  std::atomic<std::uint64_t> lost_{0};
  WakeCall call_;
};

}  // namespace dampline::app

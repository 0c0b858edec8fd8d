// SPDX-License-Identifier: MIT
#include "app/live/recorder.hpp"

#include <algorithm>
#include <chrono>

namespace dampline::app {
namespace {

constexpr std::chrono::milliseconds kWriteTurn{100};
constexpr std::size_t kNewestEvents = 200;

}  // namespace

void Recorder::start() {
  thread_ = std::thread{[this] { loop(); }};
}

void Recorder::stop() {
  if (!thread_.joinable()) return;
  stop_.store(true, std::memory_order_release);
  thread_.join();
}

void Recorder::add(const hal::Event& event) {
  const std::lock_guard lock{others_mutex_};
  others_.push_back(event);
}

hal::RecordHealth Recorder::health() const {
  const std::lock_guard lock{health_mutex_};
  return health_;
}

EventList Recorder::newest_events() const {
  EventList out;
  const std::lock_guard lock{health_mutex_};
  for (const hal::Event& event : newest_) out.add(event);
  return out;
}

void Recorder::loop() noexcept {
  take_others();  // what was added before the start stands before all that the rings hold
  while (!stop_.load(std::memory_order_acquire)) {
    turn();
    items_.wait(kWriteTurn);
  }
  turn();
  sink_.close();
  const std::lock_guard lock{health_mutex_};
  health_ = sink_.health();
}

void Recorder::turn() noexcept {
  RecordItem item;
  while (items_.pop(item)) {
    newest_ns_ = std::max(newest_ns_, item.is_event ? item.event.time_ns : item.frame.time_ns);
    if (!item.is_event) {
      sink_.write(item.frame);
      continue;
    }
    keep(item.event);
  }
  take_lost();
  take_others();
  if (rotate_.exchange(false, std::memory_order_acq_rel)) sink_.rotate();
  sink_.tick(clock_.monotonic_ns());
  const std::lock_guard lock{health_mutex_};
  health_ = sink_.health();
}

void Recorder::take_others() noexcept {
  const std::lock_guard lock{others_mutex_};
  for (const hal::Event& event : others_) keep(event);
  others_.clear();
}

void Recorder::take_lost() noexcept {
  const std::uint64_t lost = items_.lost();
  if (lost == known_lost_) return;
  keep(
      {newest_ns_, hal::EventKind::kRecordsLost, 0, static_cast<std::int64_t>(lost - known_lost_)});
  known_lost_ = lost;
}

void Recorder::keep(const hal::Event& event) noexcept {
  sink_.write(event);
  events_.add(event);
  if (event.kind == hal::EventKind::kPulse || event.kind == hal::EventKind::kWheelPulse) return;
  const std::lock_guard lock{health_mutex_};
  newest_.push_back(event);
  if (newest_.size() > kNewestEvents) newest_.pop_front();
}

}  // namespace dampline::app

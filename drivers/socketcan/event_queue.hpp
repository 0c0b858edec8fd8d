// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/event.hpp"

namespace dampline::drivers {

/// Events in a fixed ring, in the order of their time: an earlier one takes the time of the one
/// before. When the ring is full the oldest gives way.
class EventQueue {
 public:
  void push(const hal::Event& event) noexcept {
    newest_ns_ = std::max(newest_ns_, event.time_ns);
    hal::Event& place = events_[(first_ + size_) % kCapacity];
    place = event;
    place.time_ns = newest_ns_;
    if (size_ < kCapacity) {
      ++size_;
    } else {
      first_ = (first_ + 1) % kCapacity;
    }
  }
  [[nodiscard]] bool pop(hal::Event& out) noexcept {
    if (size_ == 0) return false;
    out = events_[first_];
    first_ = (first_ + 1) % kCapacity;
    --size_;
    return true;
  }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }

 private:
  static constexpr std::size_t kCapacity = 1024;
  std::array<hal::Event, kCapacity> events_{};
  std::size_t first_{0};
  std::size_t size_{0};
  std::int64_t newest_ns_{0};
};

}  // namespace dampline::drivers

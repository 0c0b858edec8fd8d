// SPDX-License-Identifier: MIT
#include "dampline/sample/channel_lane.hpp"

#include <algorithm>
#include <limits>

namespace dampline {
ChannelLane::ChannelLane(const ChannelConfig& config, double rate_hz) noexcept
    : config_{config},
      accel_{config.accel},
      counter_{config.has_counter ? config.counter : config.accel},
      multiplexor_{config.multiplexed ? config.multiplexor : config.accel},
      full_scale_{full_scale_of(config.accel)},
      rate_hz_{rate_hz},
      by_counter_{config.has_counter ? config.counter.length : 1U, rate_hz},
      by_time_{rate_hz} {
  forget();
}

void ChannelLane::forget() noexcept {
  for (Reading& reading : kept_) reading.tick = std::numeric_limits<std::int64_t>::min();
}

void ChannelLane::restart(std::int64_t first_tick) noexcept {
  by_counter_ = CounterSequence{config_.has_counter ? config_.counter.length : 1U, rate_hz_};
  by_time_ = TimeSequence{rate_hz_};
  forget();
  first_tick_ = newest_ = first_tick;
  since_start_ = 0;
}

void ChannelLane::number_by_time(const Reading& reading) noexcept {
  if (!by_time_.push(reading)) ++counts_.repeated;
  take_released();
}

void ChannelLane::take_released() noexcept {
  while (const auto reading = by_time_.pop()) store_next(*reading);
}

void ChannelLane::flush() noexcept {
  by_time_.flush();
  take_released();
}

void ChannelLane::store_late(const Reading& reading) noexcept {
  if (find(reading.tick) != nullptr) {
    ++counts_.repeated;
    ++suspects_;
    return;
  }
  ++counts_.late;
  if (reading.tick < first_tick_ || newest_ - reading.tick >= kKept) {
    ++counts_.too_late;
    ++suspects_;
    return;
  }
  kept_[slot_of(reading.tick)] = reading;
  ++counts_.readings;
  if (reading.saturated) ++counts_.saturated;
}

std::int64_t ChannelLane::oldest() const noexcept {
  return std::max(first_tick_, newest_ - kKept + 1);
}

}  // namespace dampline

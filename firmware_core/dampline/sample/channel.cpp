// SPDX-License-Identifier: MIT
#include "dampline/sample/channel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dampline {

ChannelLane::ChannelLane(const ChannelConfig& config, double rate_hz) noexcept
    : config_{config},
      accel_{config.accel},
      counter_{config.has_counter ? config.counter : config.accel},
      multiplexor_{config.multiplexed ? config.multiplexor : config.accel},
      full_scale_{full_scale_of(config.accel)},
      needed_{std::max(bytes_needed(config.accel),
                       config.has_counter ? bytes_needed(config.counter) : 0)},
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
  counting_ = lost_track_ = false;
}

bool ChannelLane::push_next(const CanFrame& frame) noexcept {
  if (!counting_ || frame.remote || frame.length < needed_ ||
      !by_counter_.place_next(counter_.bits(frame), frame.time_ns))
    return false;
  const std::int64_t raw = accel_.raw(frame);
  const bool saturated = full_scale_.reached(raw);
  newest_ = by_counter_.newest();
  Reading& kept = kept_[slot_of(newest_)];
  kept.tick = newest_;
  kept.time_ns = frame.time_ns;
  kept.accel_mps2 = accel_.physical(raw);
  kept.saturated = saturated;
  suspects_ = 0;
  ++since_start_;
  ++counts_.readings;
  if (saturated) ++counts_.saturated;
  return true;
}

void ChannelLane::store_next(const Reading& reading) noexcept {
  const std::int64_t step = since_start_ == 0 ? 1 : reading.tick - newest_;
  if (step > 1) {
    ++counts_.gaps;
    counts_.lost += static_cast<std::uint64_t>(step - 1);
  }
  kept_[slot_of(reading.tick)] = reading;
  newest_ = reading.tick;
  earliest_ns_ = std::min(
      earliest_ns_, static_cast<double>(reading.time_ns - first_ns_) - expected_ns(reading.tick));
  ++since_start_;
  ++counts_.readings;
  if (reading.saturated) ++counts_.saturated;
}

double ChannelLane::expected_ns(std::int64_t tick) const noexcept {
  return static_cast<double>(tick - first_tick_) * 1e9 / rate_hz_;
}

void ChannelLane::number_by_counter(Reading reading, std::uint64_t counter) noexcept {
  const Placement placed = by_counter_.place(counter, reading.time_ns);
  reading.tick = placed.tick;
  if (placed.streak <= 1) suspects_ = 0;
  switch (placed.place) {
    case Place::kRealigned:
      ++counts_.realigned;
      counts_.misjudged += suspects_;
      [[fallthrough]];
    case Place::kNext:
      store_next(reading);
      break;
    case Place::kBehind:
      store_late(reading);
      break;
    case Place::kLostTrack:
      ++counts_.realigned;
      counts_.misjudged += suspects_;
      suspects_ = 0;
      lost_track_ = true;
      [[fallthrough]];
    case Place::kOutOfStep:
      ++counts_.out_of_step;
      break;
  }
}

bool ChannelLane::decode(const CanFrame& frame, Reading& reading, std::uint64_t& counter) noexcept {
  if (config_.multiplexed) {
    if (!multiplexor_.fits(frame)) {
      ++counts_.wrong_length;
      return false;
    }
    if (multiplexor_.bits(frame) != config_.multiplexor_value) {
      ++counts_.other_page;
      return false;
    }
  }
  if (!accel_.fits(frame) || (config_.has_counter && !counter_.fits(frame))) {
    ++counts_.wrong_length;
    return false;
  }
  const std::int64_t raw = accel_.raw(frame);
  reading.time_ns = frame.time_ns;
  reading.accel_mps2 = accel_.physical(raw);
  reading.saturated = full_scale_.reached(raw);
  if (config_.has_counter) counter = counter_.bits(frame);
  return true;
}

void ChannelLane::push(const CanFrame& frame) noexcept {
  if (frame.remote) {
    ++counts_.not_data;
    return;
  }
  Reading reading;
  std::uint64_t counter = 0;
  if (!decode(frame, reading, counter)) return;
  if (since_start_ == 0) {
    by_counter_.start(first_tick_, counter, reading.time_ns);
    by_time_.start(first_tick_, reading.time_ns);
    reading.tick = first_tick_;
    first_ns_ = reading.time_ns;
    earliest_ns_ = 0.0;
    store_next(reading);
  } else if (config_.has_counter) {
    number_by_counter(reading, counter);
  } else {
    number_by_time(reading);
  }
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

std::int64_t ChannelLane::earliest_ns() const noexcept {
  return first_ns_ + std::llround(expected_ns(newest_) + earliest_ns_);
}

std::int64_t ChannelLane::oldest() const noexcept {
  return std::max(first_tick_, newest_ - kKept + 1);
}

}  // namespace dampline

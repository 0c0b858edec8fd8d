// SPDX-License-Identifier: MIT
#include "dampline/sample/ticks.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dampline {
namespace {

constexpr int kConfirmingFrames = 4;
constexpr double kPeriodRange = 0.5;
constexpr double kCertain = 0.49;     // of a wrap: a next counter cannot be another wrap's
constexpr double kFarTicks = 1.0;     // off the line: jitter is less, and a burst of four more
constexpr double kCatchingUp = 0.45;  // of a period: at twice the rate, still followed, it is 0.5
constexpr double kSmallStep = 1.0 / 8.0;  // of a wrap: within a burst a loss, no other counter

// A reading without a counter that comes this little after the last repeats it, in ticks.
constexpr double kRepeatedTicks = 0.25;
// A pause this long is a gap; nobody catches up with it.
constexpr std::int64_t kPauseTicks = 16;

}  // namespace

CounterSequence::CounterSequence(unsigned counter_bits, double rate_hz) noexcept
    : line_{rate_hz, kPeriodRange},
      mask_{counter_bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << counter_bits) - 1},
      wrap_{std::ldexp(1.0, static_cast<int>(counter_bits))},
      tolerance_{std::clamp(wrap_ / 64.0, 0.5, 2.0)},
      usual_{std::min(kCertain * wrap_, kFarTicks)},
      catching_up_ns_{std::llround(kCatchingUp * 1e9 / rate_hz)} {}

void CounterSequence::start(std::int64_t tick, std::uint64_t counter,
                            std::int64_t time_ns) noexcept {
  is_first_ = true;
  take(tick, counter, time_ns);
  streak_ = far_frames_ = 0;
}

std::int64_t CounterSequence::resolve(std::uint64_t ahead, double due_tick) const noexcept {
  const double due_ahead = due_tick - static_cast<double>(newest());
  if (ahead == 1 && std::abs(due_ahead - 1.0) < kCertain * wrap_) return newest() + 1;
  const double wraps = std::nearbyint((due_ahead - static_cast<double>(ahead)) / wrap_);
  // Modulo 2^64 on purpose: a counter of 64 bits that goes back one wraps to a step of -1.
  const std::uint64_t step =
      ahead + (mask_ + 1) * static_cast<std::uint64_t>(static_cast<std::int64_t>(wraps));
  return newest() + static_cast<std::int64_t>(step);
}

bool CounterSequence::fits(std::int64_t tick, double due_tick) const noexcept {
  const double off = std::abs(due_tick - static_cast<double>(tick));
  if (tick == newest() + 1) return off <= kBurstTicks;
  if (tick <= newest()) return false;
  return is_bursty() || is_first_ ? fits_in_burst(tick, off) : off <= tolerance_;
}

bool CounterSequence::fits_in_burst(std::int64_t tick, double off) const noexcept {
  const auto step = static_cast<double>(tick - newest());
  return off <= kBurstTicks && step > 0.0 && step <= std::min(kSmallStep * wrap_, kBurstTicks);
}

void CounterSequence::note_far(std::int64_t tick) noexcept {
  if (tick - far_tick_ > kBurstPause) far_frames_ = 0;
  far_frames_ = std::min(far_frames_ + 1, kBurstFrames);
  far_tick_ = tick;
}

Placement CounterSequence::accept(Place place, std::int64_t tick, std::uint64_t counter,
                                  std::int64_t time_ns) noexcept {
  take(tick, counter, time_ns);
  return {place, tick, std::exchange(streak_, 0)};
}

Placement CounterSequence::place(std::uint64_t counter, std::int64_t time_ns) noexcept {
  const std::uint64_t ahead = (counter - newest_counter_) & mask_;
  settle(time_ns, ahead);
  const double due_tick = line_.tick_at(time_ns);
  const std::int64_t tick = resolve(ahead, due_tick);
  if (fits(tick, due_tick)) {
    if (std::abs(due_tick - static_cast<double>(tick)) >= kFarTicks) note_far(tick);
    return accept(Place::kNext, tick, counter, time_ns);
  }
  return suspect(tick, counter, time_ns);
}

bool CounterSequence::continues_streak(std::uint64_t counter) const noexcept {
  return streak_ > 0 && ((counter - streak_counter_) & mask_) == 1;
}

Placement CounterSequence::suspect(std::int64_t tick, std::uint64_t counter,
                                   std::int64_t time_ns) noexcept {
  if (continues_streak(counter)) {
    ++streak_;
    ++streak_tick_;
  } else {
    streak_ = 1;
    streak_tick_ = tick;
    streak_error_ = 0.0;
  }
  streak_counter_ = counter;
  const double last_error = line_.tick_at(time_ns) - static_cast<double>(streak_tick_);
  streak_error_ += last_error;
  if (streak_ >= kConfirmingFrames) {
    const double error = streak_error_ / static_cast<double>(streak_);
    // Of frames that all come at once, each is a tick earlier for its counter than the one before.
    const bool at_once = error - last_error > 0.25 * static_cast<double>(streak_ - 1);
    if (at_once && fits_in_burst(streak_tick_, std::abs(last_error))) {
      far_frames_ = kBurstFrames;
      far_tick_ = streak_tick_;
      return accept(Place::kNext, streak_tick_, counter, time_ns);
    }
    if (is_bursty() || at_once) return {Place::kLostTrack, tick, streak_};
    const bool counter_is_right = std::abs(error) <= tolerance_ && streak_tick_ > newest();
    if (counter_is_right) return accept(Place::kNext, streak_tick_, counter, time_ns);
    const auto by_time = streak_tick_ + static_cast<std::int64_t>(std::llround(error));
    return accept(Place::kRealigned, std::max(by_time, newest() + 1), counter, time_ns);
  }
  const bool behind = tick <= newest() && static_cast<double>(newest() - tick) < kBurstTicks;
  return {behind ? Place::kBehind : Place::kOutOfStep, tick, streak_};
}

void TimeSequence::start(std::int64_t tick, std::int64_t time_ns) noexcept {
  line_.start(tick, time_ns);
  newest_ = tick;
  held_count_ = released_ = 0;
}

bool TimeSequence::push(const Reading& reading) noexcept {
  const double due_tick = line_.tick_at(reading.time_ns);
  if (due_tick < static_cast<double>(newest_) + kRepeatedTicks) return false;
  held_[held_count_++] = reading;
  const auto nearest = static_cast<std::int64_t>(std::llround(due_tick));
  const auto waiting = static_cast<std::int64_t>(held_count_);
  if (nearest - newest_ <= waiting) {
    release(true);
  } else if (held_count_ == kHeld || nearest - newest_ > kPauseTicks) {
    release(false);
  }
  return true;
}

void TimeSequence::release(bool in_sequence) noexcept {
  for (std::size_t i = 0; i < held_count_; ++i) {
    Reading& reading = held_[i];
    const auto nearest = static_cast<std::int64_t>(std::llround(line_.tick_at(reading.time_ns)));
    reading.tick = in_sequence ? newest_ + 1 : std::max(nearest, newest_ + 1);
    newest_ = reading.tick;
    line_.update(reading.tick, reading.time_ns);
  }
  released_ = held_count_;
  held_count_ = 0;
}

std::optional<Reading> TimeSequence::pop() noexcept {
  if (released_ == 0) return std::nullopt;
  const Reading first = held_[0];
  std::move(held_.begin() + 1, held_.begin() + static_cast<std::ptrdiff_t>(released_),
            held_.begin());
  --released_;
  return first;
}

void TimeSequence::flush() noexcept { release(false); }

void RateMeter::begin_segment() noexcept { count_ = 0.0; }

MeasuredRate RateMeter::measured() const noexcept {
  MeasuredRate result{0.0, 0.0, samples_};
  const double freedom = static_cast<double>(samples_) - static_cast<double>(segments_) - 1.0;
  if (!(freedom > 0.0) || !(sum_tt_ > 0.0)) return result;
  const double slope_ns = sum_td_ / sum_tt_;
  const double period_ns = nominal_period_ns_ + slope_ns;
  if (!(period_ns > 0.0)) return result;
  const double residual_ns2 = std::max(sum_dd_ - slope_ns * sum_td_, 0.0) / freedom;
  result.rate_hz = 1e9 / period_ns;
  result.std_hz = result.rate_hz * std::sqrt(residual_ns2 / sum_tt_) / period_ns;
  return result;
}

}  // namespace dampline

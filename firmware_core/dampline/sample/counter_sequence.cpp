// SPDX-License-Identifier: MIT
#include "dampline/sample/counter_sequence.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {
constexpr int kConfirmingFrames = 4;
constexpr double kPeriodRange = 0.5;
}  // namespace

CounterSequence::CounterSequence(unsigned counter_bits, double rate_hz) noexcept
    : line_{rate_hz, kPeriodRange},
      mask_{counter_bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << counter_bits) - 1},
      wrap_{std::ldexp(1.0, static_cast<int>(counter_bits))},
      tolerance_{std::clamp(wrap_ / 64.0, 0.5, 2.0)} {}

void CounterSequence::start(std::int64_t tick, std::uint64_t counter,
                            std::int64_t time_ns) noexcept {
  line_.start(tick, time_ns);
  newest_ = tick;
  newest_counter_ = counter;
  streak_ = 0;
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
  streak_error_ += line_.tick_at(time_ns) - static_cast<double>(streak_tick_);
  if (streak_ >= kConfirmingFrames) {
    const double error = streak_error_ / static_cast<double>(streak_);
    const bool counter_is_right = std::abs(error) <= tolerance_ && streak_tick_ > newest_;
    if (counter_is_right) return accept(Place::kNext, streak_tick_, counter, time_ns);
    const auto by_time = streak_tick_ + static_cast<std::int64_t>(std::llround(error));
    return accept(Place::kRealigned, std::max(by_time, newest_ + 1), counter, time_ns);
  }
  const bool behind = tick <= newest_ && static_cast<double>(newest_ - tick) < kBurstTicks;
  return {behind ? Place::kBehind : Place::kOutOfStep, tick, streak_};
}

}  // namespace dampline

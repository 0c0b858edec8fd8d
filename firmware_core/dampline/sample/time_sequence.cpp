// SPDX-License-Identifier: MIT
#include "dampline/sample/time_sequence.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {
// A reading this little after the one before is the same instant once more, in ticks.
constexpr double kRepeatedTicks = 0.25;
// A pause this long is a gap; nobody catches up with it.
constexpr std::int64_t kPauseTicks = 16;
}  // namespace

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

}  // namespace dampline

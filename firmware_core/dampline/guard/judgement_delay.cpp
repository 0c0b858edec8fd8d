// SPDX-License-Identifier: MIT
#include "dampline/guard/judgement_delay.hpp"

#include <algorithm>

namespace dampline {
namespace {

constexpr std::size_t kNeighbours = 2;  // on either side of a wrong sample

constexpr std::uint32_t bit(FaultKind kind) noexcept { return 1U << static_cast<unsigned>(kind); }

// The second holds a fault that passes and that nobody but the guards sees.
bool passes(std::uint32_t kinds) noexcept {
  if ((kinds & (bit(FaultKind::kDcJump) | bit(FaultKind::kNoiseBurst))) != 0) return true;
  const bool slips =
      (kinds & (bit(FaultKind::kLostSamples) | bit(FaultKind::kRepeatedSamples))) != 0;
  return slips && (kinds & FaultLog::kGapBit) == 0;
}

}  // namespace

bool JudgementDelay::push(const Sample& sample, Guard& guard, Sample& out) noexcept {
  if (wait_ == 0) {
    out = sample;
    return true;
  }
  newest_ = (newest_ + 1) % kRing;
  ring_[newest_] = {sample, 0};
  ++count_;
  mark_all(guard);
  if (count_ <= wait_) return false;
  take_oldest(guard, out);
  return true;
}

bool JudgementDelay::drain(Guard& guard, Sample& out) noexcept {
  if (count_ == 0) return false;
  mark_all(guard);
  take_oldest(guard, out);
  return true;
}

void JudgementDelay::mark_all(Guard& guard) noexcept {
  WrongSample wrong;
  while (guard.next_wrong_sample(wrong)) mark(wrong);
}

// Ticks rise with the place in the ring.
void JudgementDelay::mark(const WrongSample& wrong) noexcept {
  std::size_t newer = 0;  // ages: at `newer` or before it is the tick, if it waits at all
  std::size_t older = count_;
  while (newer < older) {
    const std::size_t middle = (newer + older) / 2;
    if (held(middle).sample.tick > wrong.tick) {
      newer = middle + 1;
    } else {
      older = middle;
    }
  }
  if (newer >= count_ || held(newer).sample.tick != wrong.tick) return;
  const std::uint32_t wrong_before = held(newer).wrong;
  held(newer).wrong = static_cast<std::uint8_t>(wrong_before | 1U << wrong.channel);
}

void JudgementDelay::take_oldest(const Guard& guard, Sample& out) noexcept {
  const std::size_t age = count_ - 1;
  Held& oldest = held(age);
  bool spoilt = passes(guard.spoilt(oldest.sample.tick, oldest.sample.tick));
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (!oldest.is_wrong(c)) continue;
    if (!replace(age, c)) spoilt = true;
  }
  oldest.sample.spoilt = spoilt;
  if (spoilt) ++counts_.spoilt;
  out = oldest.sample;
  --count_;
  gone_ = std::min(gone_ + 1, kNeighbours);
}

bool JudgementDelay::replace(std::size_t age, std::size_t channel) noexcept {
  if (gone_ < kNeighbours || age < kNeighbours) return false;
  Sample& sample = held(age).sample;
  for (std::size_t i = 1; i <= kNeighbours; ++i) {
    const auto step = static_cast<std::int64_t>(i);
    const Held& after = held(age - i);
    if (held(age + i).sample.tick != sample.tick - step) return false;
    if (after.sample.tick != sample.tick + step || after.is_wrong(channel)) return false;
  }
  const auto at = [&](std::size_t of) { return held(of).sample.accel_mps2[channel]; };
  sample.accel_mps2[channel] =
      (4.0 * (at(age + 1) + at(age - 1)) - at(age + 2) - at(age - 2)) / 6.0;
  const std::uint32_t saturated = sample.saturated;
  sample.saturated = static_cast<std::uint8_t>(saturated & ~(1U << channel));
  ++counts_.replaced;
  return true;
}

}  // namespace dampline

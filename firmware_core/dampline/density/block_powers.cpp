// SPDX-License-Identifier: MIT
#include "dampline/density/block_powers.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

constexpr std::size_t kQuarters = 4;
constexpr std::size_t kFewest = 8;
constexpr double kMemories = 3.0;

}  // namespace

void BlockPowers::Power::add(const Power& other) noexcept {
  motion += other.motion;
  input += other.input;
  count += other.count;
}

BlockPowers::BlockPowers(double memory_blocks) noexcept : rings_{memory_blocks > 0.0} {
  if (!rings_) return;
  const double blocks = std::ceil(kMemories * memory_blocks / static_cast<double>(kSlots));
  blocks_per_slot_ = static_cast<std::uint32_t>(std::clamp(blocks, 1.0, 1.0e9));
}

void BlockPowers::close_block() noexcept {
  if (open_.count == 0.0) return;
  if (++blocks_ < blocks_per_slot_) return;
  push(open_);
  open_ = {};
  blocks_ = 0;
}

void BlockPowers::push(const Power& slot) noexcept {
  if (size_ == kSlots && rings_) {
    slots_[oldest_] = slot;
    oldest_ = (oldest_ + 1) % kSlots;
    return;
  }
  slots_[size_++] = slot;
  if (size_ == kSlots && !rings_) coarsen();
}

void BlockPowers::coarsen() noexcept {
  const std::size_t pairs = size_ / 2;
  for (std::size_t i = 0; i < pairs; ++i) {
    Power pair = slots_[2 * i];
    pair.add(slots_[2 * i + 1]);
    slots_[i] = pair;
  }
  if (size_ % 2 == 1) open_.add(slots_[size_ - 1]);
  size_ = pairs;
  blocks_per_slot_ *= 2;
}

void BlockPowers::append(const BlockPowers& other) noexcept {
  BlockPowers tail = other;
  if (!rings_) {
    while (tail.blocks_per_slot_ < blocks_per_slot_) tail.coarsen();
    while (blocks_per_slot_ < tail.blocks_per_slot_) coarsen();
    while (size_ + tail.size_ >= kSlots) {
      coarsen();
      tail.coarsen();
    }
  }
  for (std::size_t i = 0; i < tail.size_; ++i) push(tail.slots_[(tail.oldest_ + i) % kSlots]);
  open_.add(tail.open_);
}

BlockPowers::Change BlockPowers::change_of(double Power::*power) const noexcept {
  Change out;
  if (size_ < kFewest) return out;
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  std::array<Power, kQuarters> quarters{};
  for (std::size_t i = 0; i < size_; ++i) {
    const Power& slot = slots_[(oldest_ + i) % kSlots];
    const double mean = slot.*power / slot.count;
    sum += mean;
    squares += mean * mean;
    count += 1.0;
    quarters[kQuarters * i / size_].add(slot);
  }
  const double mean = sum / count;
  if (!(mean > 0.0)) return out;
  out.known = true;
  const double variance = std::max(squares / count - mean * mean, 0.0);
  out.chance = std::sqrt(variance * static_cast<double>(kQuarters) / count) / mean;
  for (const Power& quarter : quarters) {
    const double ratio = quarter.*power / (quarter.count * mean);
    out.size = std::max(out.size, ratio > 0.0 ? std::abs(std::log(ratio)) : 1.0e3);
  }
  return out;
}

BlockPowers::Change BlockPowers::change() const noexcept {
  const Change motion = change_of(&Power::motion);
  const Change input = change_of(&Power::input);
  return motion.size - motion.chance > input.size - input.chance ? motion : input;
}

}  // namespace dampline

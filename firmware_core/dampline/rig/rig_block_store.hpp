// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/rig/rig_columns.hpp"

namespace dampline {

/// One factor per stretch of time, in fixed memory for any length of record: when the store is
/// full, neighbours merge and the stretches double. 64 to 128 blocks of equal length remain, one of
/// them still filling.
class RigBlockStore {
 public:
  static constexpr std::size_t kMaxBlocks = 128;

  explicit RigBlockStore(std::int64_t block_samples) noexcept : block_samples_{block_samples} {}

  /// Adds a row to the block that holds its centre. Ticks count from 0.
  void absorb(std::int64_t tick, const RigInformation::Row& row) noexcept {
    while (block_of(tick) >= kMaxBlocks) halve();
    const std::size_t block = block_of(tick);
    if (block + 1 > size_) size_ = block + 1;
    blocks_[block].absorb(row);
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] const RigInformation& block(std::size_t i) const noexcept { return blocks_[i]; }
  [[nodiscard]] std::int64_t block_samples() const noexcept { return block_samples_; }
  [[nodiscard]] std::size_t block_of(std::int64_t tick) const noexcept {
    return static_cast<std::size_t>(tick / block_samples_);
  }

 private:
  void halve() noexcept {
    for (std::size_t i = 0; i < kMaxBlocks / 2; ++i) {
      if (i > 0) blocks_[i] = blocks_[2 * i];
      blocks_[i].merge(blocks_[2 * i + 1]);
    }
    for (std::size_t i = kMaxBlocks / 2; i < kMaxBlocks; ++i) blocks_[i].clear();
    size_ = (size_ + 1) / 2;
    block_samples_ *= 2;
  }

  std::int64_t block_samples_;
  std::size_t size_{0};
  std::array<RigInformation, kMaxBlocks> blocks_{};
};

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// What became of a block.
enum class BlockStatus : std::uint8_t {
  kUsed,         ///< all rows
  kPartial,      ///< fewer rows: a neighbouring block was excluded, or the record began or ended
  kStill,        ///< standstill: no row passed the excitation gate
  kExcludedGap,  ///< samples are missing
  kExcludedSaturated,  ///< a channel stood at full scale
  kExcludedStuck,      ///< a channel held one value
  kExcludedNotFinite,  ///< NaN or infinite
  kExcludedSpoilt,     ///< samples that the guards spoilt
};

struct BlockReport {
  std::int64_t first_tick{0};
  BlockStatus status{BlockStatus::kPartial};
};

/// Reports that wait to be handed out, one per sample; at a gap several blocks close at once.
class BlockReports {
 public:
  void push(const BlockReport& report) noexcept { ring_[pushed_++ % ring_.size()] = report; }
  [[nodiscard]] bool pop(BlockReport& out) noexcept {
    if (popped_ == pushed_) return false;
    out = ring_[popped_++ % ring_.size()];
    return true;
  }

 private:
  std::array<BlockReport, 16> ring_{};
  std::size_t pushed_{0};
  std::size_t popped_{0};
};

/// Keeps, for the blocks that are still open, why they cannot be used.
class BlockLedger {
 public:
  enum class Fault : std::uint8_t { kNone, kGap, kSaturated, kStuck, kNotFinite, kSpoilt };

  /// The first fault of a block is the one that is reported.
  void mark(std::int64_t block, Fault fault) noexcept {
    Entry& e = entry(block);
    if (e.fault == Fault::kNone) e.fault = fault;
  }
  void add_row(std::int64_t block) noexcept { ++entry(block).rows; }
  void add_still_row(std::int64_t block) noexcept { ++entry(block).still_rows; }

  /// Status of a block that takes no more rows; `full` is how many rows a whole block has.
  [[nodiscard]] BlockStatus close(std::int64_t block, std::uint32_t full) noexcept {
    const Entry e = entry(block);
    switch (e.fault) {
      case Fault::kGap:
        return BlockStatus::kExcludedGap;
      case Fault::kSaturated:
        return BlockStatus::kExcludedSaturated;
      case Fault::kStuck:
        return BlockStatus::kExcludedStuck;
      case Fault::kNotFinite:
        return BlockStatus::kExcludedNotFinite;
      case Fault::kSpoilt:
        return BlockStatus::kExcludedSpoilt;
      case Fault::kNone:
        break;
    }
    if (e.rows == 0) return e.still_rows > 0 ? BlockStatus::kStill : BlockStatus::kPartial;
    return e.rows + e.still_rows >= full ? BlockStatus::kUsed : BlockStatus::kPartial;
  }

 private:
  struct Entry {
    std::int64_t block{-1};
    Fault fault{Fault::kNone};
    std::uint32_t rows{0};
    std::uint32_t still_rows{0};
  };
  static constexpr std::size_t kOpen = 16;  // more than lie between a sample and its rows

  Entry& entry(std::int64_t block) noexcept {
    Entry& e = entries_[static_cast<std::size_t>(block) % kOpen];
    if (e.block != block) e = {.block = block};
    return e;
  }
  std::array<Entry, kOpen> entries_{};
};

}  // namespace dampline

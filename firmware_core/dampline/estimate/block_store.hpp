// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/estimate/statistics.hpp"
#include "dampline/numeric/blocks.hpp"

namespace dampline {

/// How long the estimate remembers.
enum class Memory : std::uint8_t {
  kInfinite,    ///< everything since the start
  kWindow,      ///< a sliding window: a ring of block factors, merged on demand
  kForgetting,  ///< exponential, by a time constant of moving time
};

struct MemoryConfig {
  Memory memory{Memory::kInfinite};
  double memory_blocks{0.0};  ///< window length or time constant
  /// Of the total, when a block is added to it: nothing is forgotten at a standstill.
  [[nodiscard]] double kept() const noexcept;
  /// Entries so long that `most` of them cover what is remembered: a power of two of blocks.
  [[nodiscard]] std::uint32_t longest_entry(std::size_t most) const noexcept;
};

/// Block factors on their way into the memory. Rows go into an open block; a closed block is merged
/// into the total and into the newest entry a few factor rows per sample, so that no single sample
/// pays for it. With infinite memory the entries double their length when all are full. Only blocks
/// that hold rows count, so nothing is forgotten at a standstill.
class BlockStore {
 public:
  using Config = MemoryConfig;
  static constexpr bool kHasWindow = true;
  /// Merges of one factor row each in one call of step().
  static constexpr int kMergesPerStep = 4;

  explicit BlockStore(const Config& config) noexcept;

  /// Adds a row to open block `block`. At most three consecutive blocks are open or being merged,
  /// and of one scale rows come block after block. Rows are gathered to panels of kPanel.
  void absorb(std::int64_t block, std::size_t scale, const GalerkinRow& row) noexcept;
  /// Rows of an open block so far, all scales.
  [[nodiscard]] double rows(std::int64_t block) const noexcept;
  /// No more rows of this block will come. Its slot is free again at most 420 steps later, which is
  /// less than the block and a half until block + 3 needs it.
  void close(std::int64_t block) noexcept;
  /// A bounded part of the pending work.
  void step() noexcept;
  /// All pending work, at once.
  void finish() noexcept;

  /// Everything merged so far. Call finish() first; with a window this merges the ring.
  void total_to(ScaleFactors& out) const noexcept;
  /// Entries, oldest first; returns how many.
  std::size_t entries_to(std::array<const ScaleFactors*, kEntries>& out) const noexcept;
  [[nodiscard]] std::uint32_t blocks_per_entry() const noexcept {
    return entries_.blocks_per_entry();
  }
  /// use(total, entries), when all pending work is done. A window's total is made where the others
  /// gather theirs: it is 9 KiB, too much for a stack.
  template <class Use>
  auto summed_up(const Use& use) noexcept {
    finish();
    if (config_.memory == Memory::kWindow) merge_entries(total_);
    std::array<const ScaleFactors*, kEntries> entries{};
    const std::size_t count = entries_to(entries);
    return use(total_, EntryList{entries}.first(count));
  }
  /// Forgets everything that was merged; open blocks stay.
  void clear() noexcept;

 private:
  enum class Phase : std::uint8_t { kIdle, kIntoEntry, kIntoTotal };
  static constexpr std::size_t kSlots = 3;
  static constexpr std::size_t kPanel = 8;
  using Waiting = WaitingBlocks<kSlots>;
  using Entries = BlockEntries<ScaleFactors, kEntries>;
  /// Rows of one scale and block that are not yet in the block's factor.
  struct Panel {
    RowFactor::Panel<kPanel> rows{};
    std::size_t count{0};
    std::size_t slot{0};
  };

  [[nodiscard]] static Entries entries_for(const Config& config) noexcept;
  void absorb_panel(std::size_t scale) noexcept;
  void merge_entries(ScaleFactors& out) const noexcept;
  void start() noexcept;
  void advance() noexcept;
  [[nodiscard]] bool into_total(const ScaleFactors& from) noexcept;

  Config config_;
  std::array<ScaleFactors, kSlots> open_{};
  std::array<Panel, kScales> panels_{};
  Entries entries_;
  ScaleFactors total_;
  Phase phase_{Phase::kIdle};
  Waiting waiting_;
  int cursor_{0};  // part of the block that goes into the total
};

}  // namespace dampline

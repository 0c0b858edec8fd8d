// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/estimate/statistics.hpp"

namespace dampline {

/// How long the estimate remembers.
enum class Memory : std::uint8_t {
  kInfinite,    ///< everything since the start
  kWindow,      ///< a sliding window: a ring of block factors, merged on demand
  kForgetting,  ///< exponential, by a time constant of moving time
};

/// Block factors on their way into the memory. Rows go into an open block; a closed block is merged
/// into the total and into the newest entry a few factor rows per sample, so that no single sample
/// pays for it. With infinite memory the entries double their length when all are full. Only blocks
/// that hold rows count, so nothing is forgotten at a standstill.
class BlockStore {
 public:
  struct Config {
    Memory memory{Memory::kInfinite};
    double memory_blocks{0.0};  ///< window length or time constant
  };
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
  [[nodiscard]] std::uint32_t blocks_per_entry() const noexcept { return blocks_per_entry_; }
  [[nodiscard]] Memory memory() const noexcept { return config_.memory; }
  /// Forgets everything that was merged; open blocks stay.
  void clear() noexcept;

 private:
  enum class Phase : std::uint8_t { kIdle, kCompact, kIntoEntry, kIntoTotal };
  static constexpr std::size_t kSlots = 3;
  static constexpr std::size_t kPanel = 8;
  /// Rows of one scale and block that are not yet in the block's factor.
  struct Panel {
    RowFactor::Panel<kPanel> rows{};
    std::size_t count{0};
    std::size_t slot{0};
  };
  static constexpr int kRowsOfBlock = static_cast<int>(kScales) * kRowColumns;
  static constexpr int kPairs = static_cast<int>(kEntries / 2);

  [[nodiscard]] static std::size_t slot(std::int64_t block) noexcept {
    return static_cast<std::size_t>(block) % kSlots;
  }
  [[nodiscard]] ScaleFactors& entry(std::size_t i) noexcept {
    return entries_[(head_ + i) % kEntries];
  }
  void absorb_panel(std::size_t scale) noexcept;
  void start() noexcept;
  void open_entry() noexcept;
  void advance() noexcept;

  Config config_;
  std::uint32_t blocks_per_entry_{1};
  std::size_t limit_{kEntries};  // entries in use at most
  std::array<ScaleFactors, kSlots> open_{};
  std::array<Panel, kScales> panels_{};
  std::array<ScaleFactors, kEntries> entries_{};
  std::size_t head_{0};
  std::size_t count_{0};
  ScaleFactors total_;
  Phase phase_{Phase::kIdle};
  std::array<std::size_t, kSlots> pending_{};  // slots to be merged, the first one now
  std::size_t pending_count_{0};
  int cursor_{0};  // factor row, then pair, within the phase
};

/// Merges the factor rows of one block into another: step `cursor` of kScales * kRowColumns.
void merge_step(ScaleFactors& into, const ScaleFactors& from, int cursor) noexcept;
void merge_counts(ScaleFactors& into, const ScaleFactors& from) noexcept;
/// into += from, whole.
void merge_all(ScaleFactors& into, const ScaleFactors& from) noexcept;

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dampline/estimate/block_store.hpp"

namespace dampline {

/// Scales that share a factor: the long ones, which know the stiffness, and the fastest.
inline constexpr std::size_t kGroups = 2;
[[nodiscard]] constexpr std::size_t group_of(std::size_t scale) noexcept {
  return scale + 1 < kScales ? 0 : 1;
}

/// What ScaleFactors holds, in a fifth of the memory: the rows of a group's scales in one factor,
/// each divided by its scale's residual as it was known then, in single precision. Good for
/// deviations and held-out errors, which need no more than that; not for the estimate itself.
struct GroupedFactors {
  using Factor = Information<kRowColumns, float>;
  std::array<Factor, kGroups> factor{};
  std::uint32_t blocks{0};

  void clear() noexcept {
    for (Factor& f : factor) f.clear();
    blocks = 0;
  }
  static constexpr int kParts = static_cast<int>(kGroups) * kRowColumns;
  int merge(const GroupedFactors& from, int part) noexcept {
    const auto group = static_cast<std::size_t>(part / kRowColumns);
    factor[group].absorb_row_of(from.factor[group], part % kRowColumns);
    return 1;
  }
  void merge_counts(const GroupedFactors& from) noexcept { blocks += from.blocks; }
  void copy(const GroupedFactors& from, int part) noexcept {
    const auto group = static_cast<std::size_t>(part / kRowColumns);
    if (part % kRowColumns == 0) factor[group] = from.factor[group];
  }
  void copy_counts(const GroupedFactors& from) noexcept { blocks = from.blocks; }
};
using GroupedList = std::span<const GroupedFactors* const>;

/// BlockStore for little memory. A row goes into the total at once and into its open block's
/// factor; entries and open blocks are GroupedFactors. There is no sliding window.
class GroupedStore {
 public:
  using Config = MemoryConfig;
  static constexpr std::size_t kMostEntries = 16;
  static constexpr bool kHasWindow = false;

  explicit GroupedStore(const Config& config) noexcept;

  /// Adds a row to open block `block`; at most two consecutive blocks are open or being merged.
  void absorb(std::int64_t block, std::size_t scale, const GalerkinRow& row) noexcept;
  /// No more rows of this block will come. Its place is free again at most 190 steps later.
  void close(std::int64_t block) noexcept;
  void step() noexcept;
  void finish() noexcept;
  template <class Use>
  auto summed_up(const Use& use) noexcept {
    finish();
    std::array<const GroupedFactors*, kMostEntries> entries{};
    for (std::size_t i = 0; i < entries_.size(); ++i) entries[i] = &entries_[i];
    return use(total_, GroupedList{entries}.first(entries_.size()));
  }
  [[nodiscard]] std::uint32_t blocks_per_entry() const noexcept {
    return entries_.blocks_per_entry();
  }
  void clear() noexcept;

 private:
  static constexpr std::size_t kSlots = 2;
  static constexpr int kMergesPerStep = 2;
  using Waiting = WaitingBlocks<kSlots>;
  using Entries = BlockEntries<GroupedFactors, kMostEntries>;
  struct Open {
    GroupedFactors factors;
    std::uint32_t rows{0};
    bool weighed{false};  // its rows are in the factors; those of the first blocks cannot be
  };

  /// True when every scale has shown its residual.
  [[nodiscard]] bool weigh() noexcept;
  void forget() noexcept;
  void advance() noexcept;

  Config config_;
  std::array<Open, kSlots> open_{};
  std::array<double, kScales> root_weight_{};  ///< 1 / what a row leaves, rms, by scale
  Entries entries_;
  ScaleFactors total_;
  Waiting waiting_;
};

}  // namespace dampline

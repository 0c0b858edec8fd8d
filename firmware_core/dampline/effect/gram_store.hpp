// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/effect/gram.hpp"

namespace dampline::effect {

inline constexpr std::size_t kEffectEntries = 40;

/// Sums of blocks on their way into a fixed number of entries. When all are full, neighbours are
/// joined two by two and entries become twice as long; the work is spread over the steps.
class GramStore {
 public:
  void absorb(std::int64_t block, std::size_t scale, const Row& row) noexcept {
    ScaleGrams& open = open_[slot(block)];
    open.gram[scale].absorb(row);
    open.rows[scale] += 1.0;
  }
  /// No more rows of this block will come. Its slot is needed again for block + 3.
  void close(std::int64_t block) noexcept;
  /// A bounded part of the pending work: one addition of a Gram matrix.
  void step() noexcept;
  void finish() noexcept {
    while (phase_ != Phase::kIdle) step();
  }

  /// Entries, oldest first.
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] const ScaleGrams& entry(std::size_t i) const noexcept { return entries_[i]; }
  [[nodiscard]] std::uint32_t blocks_per_entry() const noexcept { return blocks_per_entry_; }

  /// For a copy that is made part by part: how often the entries have begun to change, whether they
  /// are changing now, and how many parts they have.
  [[nodiscard]] std::uint64_t revision() const noexcept { return revision_; }
  [[nodiscard]] bool is_changing() const noexcept { return phase_ != Phase::kIdle; }
  [[nodiscard]] std::size_t parts() const noexcept { return count_ * kScales; }
  /// One matrix of another store's entries, with what belongs to it.
  void copy_part(const GramStore& from, std::size_t part) noexcept;

 private:
  enum class Phase : std::uint8_t { kIdle, kCompact, kMerge };
  static constexpr std::size_t kSlots = 3;
  [[nodiscard]] static std::size_t slot(std::int64_t block) noexcept {
    return static_cast<std::size_t>(block) % kSlots;
  }
  void start() noexcept;
  void compact() noexcept;
  void merge() noexcept;

  std::uint32_t blocks_per_entry_{1};
  std::array<ScaleGrams, kSlots> open_{};
  std::array<ScaleGrams, kEffectEntries> entries_{};
  std::size_t count_{0};
  std::uint64_t revision_{0};
  Phase phase_{Phase::kIdle};
  std::size_t cursor_{0};
  std::array<std::size_t, kSlots> pending_{};
  std::size_t pending_count_{0};
};

}  // namespace dampline::effect

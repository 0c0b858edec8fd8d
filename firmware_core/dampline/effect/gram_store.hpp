// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/basis/window_bank.hpp"
#include "dampline/effect/columns.hpp"
#include "dampline/numeric/blocks.hpp"

namespace dampline::effect {

using Row = Eigen::Matrix<double, kColumns, 1>;

/// Sums of products of all columns: the packed upper triangle of [A t]'[A t].
class Gram {
 public:
  static constexpr std::size_t kSize = static_cast<std::size_t>(kColumns) * (kColumns + 1) / 2;

  void absorb(const Row& row) noexcept {
    double* out = sum_.data();
    for (int i = 0; i < kColumns; ++i) {
      const double x = row[i];
      for (int j = i; j < kColumns; ++j) *out++ += x * row[j];
    }
  }
  void add(const Gram& other, double weight = 1.0) noexcept {
    for (std::size_t i = 0; i < kSize; ++i) sum_[i] += weight * other.sum_[i];
  }
  void clear() noexcept { sum_.fill(0.0); }
  [[nodiscard]] double at(int i, int j) const noexcept {
    return i <= j ? sum_[offset(i) + static_cast<std::size_t>(j - i)]
                  : sum_[offset(j) + static_cast<std::size_t>(i - j)];
  }

 private:
  static constexpr std::size_t offset(int i) noexcept {
    return static_cast<std::size_t>(i * kColumns - i * (i - 1) / 2);
  }
  std::array<double, kSize> sum_{};
};

/// One Gram matrix per scale, and how many rows it holds.
struct ScaleGrams {
  std::array<Gram, kScales> gram{};
  std::array<double, kScales> rows{};
  std::uint32_t blocks{0};

  void clear() noexcept {
    for (Gram& g : gram) g.clear();
    rows.fill(0.0);
    blocks = 0;
  }
  /// As BlockEntries gathers them: a matrix at a time.
  static constexpr int kParts = static_cast<int>(kScales);
  int merge(const ScaleGrams& from, int part) noexcept {
    gram[static_cast<std::size_t>(part)].add(from.gram[static_cast<std::size_t>(part)]);
    return 1;
  }
  void merge_counts(const ScaleGrams& from) noexcept {
    for (std::size_t s = 0; s < kScales; ++s) rows[s] += from.rows[s];
    blocks += from.blocks;
  }
  void copy(const ScaleGrams& from, int part) noexcept {
    gram[static_cast<std::size_t>(part)] = from.gram[static_cast<std::size_t>(part)];
  }
  void copy_counts(const ScaleGrams& from) noexcept {
    rows = from.rows;
    blocks = from.blocks;
  }
};

inline constexpr std::size_t kEffectEntries = 40;

/// Sums of blocks on their way into a fixed number of entries, whose neighbours join when all are
/// full; the work is spread over the steps.
class GramStore {
 public:
  void absorb(std::int64_t block, std::size_t scale, const Row& row) noexcept {
    ScaleGrams& open = open_[Waiting::slot(block)];
    open.gram[scale].absorb(row);
    open.rows[scale] += 1.0;
  }
  /// No more rows of this block will come. Its slot is needed again for block + 3.
  void close(std::int64_t block) noexcept;
  /// A bounded part of the pending work: one addition of a Gram matrix.
  void step() noexcept;
  void finish() noexcept {
    while (is_changing()) step();
  }

  /// Entries, oldest first.
  [[nodiscard]] std::size_t count() const noexcept { return entries_.size(); }
  [[nodiscard]] const ScaleGrams& entry(std::size_t i) const noexcept { return entries_[i]; }
  [[nodiscard]] std::uint32_t blocks_per_entry() const noexcept {
    return entries_.blocks_per_entry();
  }

  /// In all entries and scales.
  [[nodiscard]] double rows() const noexcept {
    double out = 0.0;
    for (std::size_t i = 0; i < count(); ++i)
      for (const double rows : entry(i).rows) out += rows;
    return out;
  }

  /// For a copy that is made part by part: how often the entries have begun to change, whether they
  /// are changing now, and how many parts they have.
  [[nodiscard]] std::uint64_t revision() const noexcept { return revision_; }
  [[nodiscard]] bool is_changing() const noexcept { return !waiting_.empty(); }
  [[nodiscard]] std::size_t parts() const noexcept { return count() * kScales; }
  /// One matrix of another store's entries, with what belongs to it.
  void copy_part(const GramStore& from, std::size_t part) noexcept;
  /// Forgets all but the oldest entries; of a copy that takes no more rows.
  void keep_oldest(std::size_t entries) noexcept { entries_.keep_oldest(entries); }

 private:
  static constexpr std::size_t kSlots = 3;
  using Waiting = WaitingBlocks<kSlots>;
  void start() noexcept;

  std::array<ScaleGrams, kSlots> open_{};
  BlockEntries<ScaleGrams, kEffectEntries> entries_{};
  std::uint64_t revision_{0};
  Waiting waiting_;
};

/// A copy of a store's entries beside its updates, one matrix a step, so that no sample pays for
/// all of it. The copy is of one moment: when the store changes meanwhile, it begins anew.
class StoreCopy {
 public:
  void start() noexcept { part_ = 0; }
  /// The next part; true when the copy is whole.
  bool step(const GramStore& from) noexcept {
    if (part_ == 0 || from.revision() != revision_) {
      revision_ = from.revision();
      part_ = 0;
    }
    if (from.is_changing()) {
      part_ = 0;
      return false;
    }
    if (part_ < from.parts()) copy_.copy_part(from, part_++);
    return part_ == from.parts();
  }
  [[nodiscard]] const GramStore& store() const noexcept { return copy_; }

 private:
  std::size_t part_{0};
  std::uint64_t revision_{0};
  GramStore copy_;
};

}  // namespace dampline::effect

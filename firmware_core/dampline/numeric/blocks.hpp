// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// Fixed memory for a record of any length: when all entries are in use, neighbours join two by two
/// and each stands for twice the time. join(entry, next) takes the next one in; an odd last entry
/// stays as it is. Returns how many are left.
template <class Entries, class Join>
std::size_t join_neighbours(Entries& entries, std::size_t count, const Join& join) noexcept {
  for (std::size_t i = 0; 2 * i < count; ++i) {
    if (i > 0) entries[i] = entries[2 * i];
    if (2 * i + 1 < count) join(entries[i], entries[2 * i + 1]);
  }
  return (count + 1) / 2;
}

/// Places of blocks that take no more rows and wait to be gathered, the first one now.
template <std::size_t kSlots>
class WaitingBlocks {
 public:
  /// Block b is gathered in place b % kSlots, until it was taken.
  [[nodiscard]] static std::size_t slot(std::int64_t block) noexcept {
    return static_cast<std::size_t>(block) % kSlots;
  }
  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  [[nodiscard]] bool full() const noexcept { return count_ == kSlots; }
  [[nodiscard]] std::size_t first() const noexcept { return slots_[0]; }
  [[nodiscard]] bool holds(std::size_t slot) const noexcept {
    const auto end = slots_.begin() + static_cast<std::ptrdiff_t>(count_);
    return std::find(slots_.begin(), end, slot) != end;
  }
  void push(std::size_t slot) noexcept { slots_[count_++] = slot; }
  void pop() noexcept {
    std::shift_left(slots_.begin(), slots_.end(), 1);
    --count_;
  }

 private:
  std::array<std::size_t, kSlots> slots_{};
  std::size_t count_{0};
};

/// Blocks in their order in time, gathered into a fixed number of entries, one part after the
/// other, so that no single sample pays for all of one. An entry stands for one block at first.
/// When all are in use, neighbours join two by two and each stands for twice the time; once an
/// entry is as long as it may be, the oldest leaves instead.
///
/// Entry: `blocks`, how many it stands for; kParts; clear(); merge(from, part) adds a part and
/// returns how many it did at once; copy(from, part); the same of the counts beside the parts.
template <class Entry, std::size_t kMost>
class BlockEntries {
  static_assert(kMost % 2 == 0);

 public:
  static constexpr std::uint32_t kNeverFull = 0x80000000U;
  /// `longest`: blocks per entry at most, a power of two; `limit`: entries of that length that are
  /// kept, at least kMost / 2.
  explicit BlockEntries(std::uint32_t longest = kNeverFull, std::size_t limit = kMost) noexcept
      : longest_{longest}, limit_{limit} {}

  /// How many; [0] is the oldest.
  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] const Entry& operator[](std::size_t i) const noexcept {
    return entries_[(head_ + i) % kMost];
  }
  [[nodiscard]] Entry& operator[](std::size_t i) noexcept { return entries_[(head_ + i) % kMost]; }
  [[nodiscard]] std::uint32_t blocks_per_entry() const noexcept { return blocks_per_entry_; }
  /// As new: entries stand for one block again. No block may be half in.
  void clear() noexcept {
    head_ = count_ = 0;
    blocks_per_entry_ = 1;
  }
  void keep_oldest(std::size_t entries) noexcept { count_ = std::min(count_, entries); }
  /// Takes the shape of another one, without what is in it.
  void resize_as(const BlockEntries& other) noexcept {
    head_ = other.head_;
    count_ = other.count_;
    blocks_per_entry_ = other.blocks_per_entry_;
  }

  /// A block is to be taken: step() until it is in.
  void begin() noexcept {
    cursor_ = 0;
    joining_ = blocks_per_entry_ < longest_ && count_ == kMost && !has_room();
    if (!joining_) open();
  }
  /// True where the next step adds this part of the block, and is not one of joining.
  [[nodiscard]] bool adds(int part) const noexcept { return !joining_ && cursor_ == part; }
  /// One part of the work; true when the block is in.
  bool step(const Entry& from) noexcept {
    if (joining_) {
      join();
      return false;
    }
    Entry& into = (*this)[count_ - 1];
    cursor_ += into.merge(from, cursor_);
    if (cursor_ < Entry::kParts) return false;
    into.merge_counts(from);
    return true;
  }

 private:
  [[nodiscard]] bool has_room() const noexcept {
    return count_ > 0 && (*this)[count_ - 1].blocks < blocks_per_entry_;
  }
  [[nodiscard]] std::size_t limit() const noexcept {
    return blocks_per_entry_ < longest_ ? kMost : limit_;
  }
  void open() noexcept {
    if (has_room()) return;
    if (count_ == limit()) {
      head_ = (head_ + 1) % kMost;  // the oldest entry leaves
    } else {
      ++count_;
    }
    (*this)[count_ - 1].clear();
  }
  void join() noexcept {
    const auto pair = static_cast<std::size_t>(cursor_ / Entry::kParts);
    const int part = cursor_ % Entry::kParts;
    Entry& into = (*this)[pair];
    const Entry& next = (*this)[2 * pair + 1];
    if (pair > 0) into.copy((*this)[2 * pair], part);
    into.merge(next, part);
    if (part == Entry::kParts - 1) {
      if (pair > 0) into.copy_counts((*this)[2 * pair]);
      into.merge_counts(next);
    }
    if (++cursor_ < Entry::kParts * static_cast<int>(kMost / 2)) return;
    count_ = kMost / 2;
    blocks_per_entry_ *= 2;
    joining_ = false;
    cursor_ = 0;
    open();
  }

  std::uint32_t longest_;
  std::size_t limit_;
  std::uint32_t blocks_per_entry_{1};
  std::array<Entry, kMost> entries_{};
  std::size_t head_{0};
  std::size_t count_{0};
  bool joining_{false};
  int cursor_{0};  // part, in joining of all pairs
};

}  // namespace dampline

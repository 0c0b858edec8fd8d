// SPDX-License-Identifier: MIT
#include "dampline/effect/gram_store.hpp"

#include <algorithm>

namespace dampline::effect {
namespace {

double rows_of(const ScaleGrams& grams) noexcept {
  double sum = 0.0;
  for (const double n : grams.rows) sum += n;
  return sum;
}

void add_counts(ScaleGrams& into, const ScaleGrams& from) noexcept {
  for (std::size_t s = 0; s < kScales; ++s) into.rows[s] += from.rows[s];
  into.blocks += from.blocks;
}

}  // namespace

void GramStore::close(std::int64_t block) noexcept {
  if (rows_of(open_[slot(block)]) == 0.0 || pending_count_ == kSlots) return;
  open_[slot(block)].blocks = 1;
  pending_[pending_count_++] = slot(block);
  if (pending_count_ == 1) start();
}

void GramStore::copy_part(const GramStore& from, std::size_t part) noexcept {
  const std::size_t e = part / kScales;
  const std::size_t scale = part % kScales;
  entries_[e].gram[scale] = from.entries_[e].gram[scale];
  entries_[e].rows[scale] = from.entries_[e].rows[scale];
  entries_[e].blocks = from.entries_[e].blocks;
  count_ = from.count_;
  blocks_per_entry_ = from.blocks_per_entry_;
}

void GramStore::start() noexcept {
  ++revision_;
  cursor_ = 0;
  const bool room = count_ > 0 && entries_[count_ - 1].blocks < blocks_per_entry_;
  phase_ = !room && count_ == kEffectEntries ? Phase::kCompact : Phase::kMerge;
}

void GramStore::compact() noexcept {
  const std::size_t pair = cursor_ / kScales;
  const std::size_t scale = cursor_ % kScales;
  ScaleGrams& into = entries_[pair];
  const ScaleGrams& from = entries_[2 * pair];
  const ScaleGrams& next = entries_[2 * pair + 1];
  if (pair > 0) into.gram[scale] = from.gram[scale];
  into.gram[scale].add(next.gram[scale]);
  if (scale + 1 == kScales) {
    if (pair > 0) {
      into.rows = from.rows;
      into.blocks = from.blocks;
    }
    add_counts(into, next);
  }
  if (++cursor_ < kScales * (kEffectEntries / 2)) return;
  count_ = kEffectEntries / 2;
  blocks_per_entry_ *= 2;
  cursor_ = 0;
  phase_ = Phase::kMerge;
}

void GramStore::merge() noexcept {
  ScaleGrams& from = open_[pending_[0]];
  const bool fresh = count_ == 0 || entries_[count_ - 1].blocks >= blocks_per_entry_;
  if (cursor_ == 0 && fresh) {
    ++count_;
    entries_[count_ - 1].clear();
  }
  ScaleGrams& into = entries_[count_ - 1];
  into.gram[cursor_].add(from.gram[cursor_]);
  if (++cursor_ < kScales) return;
  add_counts(into, from);
  from.clear();
  phase_ = Phase::kIdle;
  std::shift_left(pending_.begin(), pending_.end(), 1);
  if (--pending_count_ > 0) start();
}

void GramStore::step() noexcept {
  if (phase_ == Phase::kCompact) {
    compact();
  } else if (phase_ == Phase::kMerge) {
    merge();
  }
}

}  // namespace dampline::effect

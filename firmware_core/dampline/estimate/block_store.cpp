// SPDX-License-Identifier: MIT
#include "dampline/estimate/block_store.hpp"

#include <algorithm>
#include <cmath>

#include "dampline/numeric/wide.hpp"

namespace dampline {

namespace {
constexpr std::size_t kWorthAPanel = 4;  // fewer rows cost less one by one

DAMPLINE_WIDE void rotate(RowFactor& into, const GalerkinRow& row, int first) noexcept {
  into.absorb(row, first);
}
}  // namespace

void merge_step(ScaleFactors& into, const ScaleFactors& from, int cursor) noexcept {
  const auto scale = static_cast<std::size_t>(cursor / kRowColumns);
  const int row = cursor % kRowColumns;
  rotate(into.factor[scale], from.factor[scale].row(row), row);
}

void merge_counts(ScaleFactors& into, const ScaleFactors& from) noexcept {
  for (std::size_t s = 0; s < kScales; ++s) into.rows[s] += from.rows[s];
  into.blocks += from.blocks;
}

void merge_all(ScaleFactors& into, const ScaleFactors& from) noexcept {
  for (std::size_t s = 0; s < kScales; ++s) into.factor[s].merge(from.factor[s]);
  merge_counts(into, from);
}

BlockStore::BlockStore(const Config& config) noexcept : config_{config} {
  // The ring covers the window, or five time constants.
  const double covered = config.memory == Memory::kWindow       ? config.memory_blocks
                         : config.memory == Memory::kForgetting ? 5.0 * config.memory_blocks
                                                                : 0.0;
  const double length = std::ceil(covered / static_cast<double>(kEntries));
  blocks_per_entry_ = static_cast<std::uint32_t>(std::max(1.0, length));
  if (config.memory == Memory::kWindow) {
    limit_ = static_cast<std::size_t>(std::ceil(config.memory_blocks / blocks_per_entry_));
  }
}

void BlockStore::absorb(std::int64_t block, std::size_t scale, const GalerkinRow& row) noexcept {
  Panel& panel = panels_[scale];
  if (panel.count == kPanel || panel.slot != slot(block)) absorb_panel(scale);
  panel.slot = slot(block);
  panel.rows.set(panel.count++, row);
  open_[panel.slot].rows[scale] += 1.0;
}

void BlockStore::absorb_panel(std::size_t scale) noexcept {
  Panel& panel = panels_[scale];
  RowFactor& factor = open_[panel.slot].factor[scale];
  if (panel.count < kWorthAPanel) {
    for (std::size_t i = 0; i < panel.count; ++i) factor.absorb(panel.rows.row(i));
  } else {
    for (std::size_t i = panel.count; i < kPanel; ++i) panel.rows.clear(i);
    factor.absorb_panel(panel.rows);
  }
  panel.count = 0;
}

double BlockStore::rows(std::int64_t block) const noexcept {
  double sum = 0.0;
  for (const double n : open_[slot(block)].rows) sum += n;
  return sum;
}

void BlockStore::close(std::int64_t block) noexcept {
  if (rows(block) == 0.0 || pending_count_ == kSlots) return;
  pending_[pending_count_++] = slot(block);
  if (pending_count_ == 1) start();
}

void BlockStore::start() noexcept {
  open_[pending_[0]].blocks = 1;
  cursor_ = 0;
  if (config_.memory == Memory::kForgetting) {
    const double keep = std::exp(-1.0 / config_.memory_blocks);
    for (RowFactor& f : total_.factor) f.scale(std::sqrt(keep));
    for (double& n : total_.rows) n *= keep;
  }
  const bool full = count_ == limit_ && entry(count_ - 1).blocks >= blocks_per_entry_;
  phase_ = full && config_.memory == Memory::kInfinite ? Phase::kCompact : Phase::kIntoEntry;
  if (phase_ == Phase::kIntoEntry) open_entry();
}

void BlockStore::open_entry() noexcept {
  if (count_ > 0 && entry(count_ - 1).blocks < blocks_per_entry_) return;
  if (count_ == limit_) {
    head_ = (head_ + 1) % kEntries;  // the window slides: the oldest entry leaves
  } else {
    ++count_;
  }
  entry(count_ - 1).clear();
}

void BlockStore::advance() noexcept {
  if (phase_ == Phase::kCompact) {
    const int pair = cursor_ / kRowsOfBlock;
    const auto target = static_cast<std::size_t>(pair);
    const int step = cursor_ % kRowsOfBlock;
    if (step == 0 && pair > 0) entry(target) = entry(2 * target);
    merge_step(entry(target), entry(2 * target + 1), step);
    if (step == kRowsOfBlock - 1) merge_counts(entry(target), entry(2 * target + 1));
    if (++cursor_ < kPairs * kRowsOfBlock) return;
    count_ = kEntries / 2;
    blocks_per_entry_ *= 2;
    open_entry();
    phase_ = Phase::kIntoEntry;
    cursor_ = 0;
    return;
  }
  ScaleFactors& from = open_[pending_[0]];
  ScaleFactors& into = phase_ == Phase::kIntoEntry ? entry(count_ - 1) : total_;
  if (cursor_ % kRowColumns == 0) {  // one scale's last rows at a time, when its factor is needed
    const auto scale = static_cast<std::size_t>(cursor_ / kRowColumns);
    if (panels_[scale].slot == pending_[0]) absorb_panel(scale);
  }
  if (into.blocks == 0) {  // nothing to merge with
    const auto scale = static_cast<std::size_t>(cursor_ / kRowColumns);
    into.factor[scale] = from.factor[scale];
    cursor_ += kRowColumns;
  } else {
    merge_step(into, from, cursor_++);
  }
  if (cursor_ < kRowsOfBlock) return;
  cursor_ = 0;
  merge_counts(into, from);
  if (phase_ == Phase::kIntoEntry) {
    phase_ = Phase::kIntoTotal;
    return;
  }
  from.clear();
  phase_ = Phase::kIdle;
  std::shift_left(pending_.begin(), pending_.end(), 1);
  if (--pending_count_ > 0) start();
}

void BlockStore::step() noexcept {
  for (int i = 0; i < kMergesPerStep && phase_ != Phase::kIdle; ++i) advance();
}

void BlockStore::finish() noexcept {
  while (phase_ != Phase::kIdle) advance();
}

void BlockStore::total_to(ScaleFactors& out) const noexcept {
  if (config_.memory != Memory::kWindow) {
    out = total_;
    return;
  }
  out.clear();
  for (std::size_t i = 0; i < count_; ++i) merge_all(out, entries_[(head_ + i) % kEntries]);
}

std::size_t BlockStore::entries_to(std::array<const ScaleFactors*, kEntries>& out) const noexcept {
  for (std::size_t i = 0; i < count_; ++i) out[i] = &entries_[(head_ + i) % kEntries];
  return count_;
}

void BlockStore::clear() noexcept {
  finish();
  total_.clear();
  count_ = 0;
  head_ = 0;
}

}  // namespace dampline

// SPDX-License-Identifier: MIT
#include "dampline/estimate/block_store.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "dampline/numeric/wide.hpp"

namespace dampline {

namespace {
constexpr std::size_t kWorthAPanel = 4;  // fewer rows cost less one by one

DAMPLINE_WIDE void rotate(RowFactor& into, const GalerkinRow& row, int first) noexcept {
  into.absorb(row, first);
}
}  // namespace

int ScaleFactors::merge(const ScaleFactors& from, int part) noexcept {
  const auto scale = static_cast<std::size_t>(part / kRowColumns);
  if (blocks == 0) {  // nothing to merge with
    factor[scale] = from.factor[scale];
    return kRowColumns;
  }
  const int row = part % kRowColumns;
  rotate(factor[scale], from.factor[scale].row(row), row);
  return 1;
}

void ScaleFactors::merge_counts(const ScaleFactors& from) noexcept {
  for (std::size_t s = 0; s < kScales; ++s) rows[s] += from.rows[s];
  blocks += from.blocks;
}

void ScaleFactors::merge(const ScaleFactors& from) noexcept {
  for (std::size_t s = 0; s < kScales; ++s) factor[s].merge(from.factor[s]);
  merge_counts(from);
}

double MemoryConfig::kept() const noexcept {
  return memory == Memory::kForgetting ? std::exp(-1.0 / memory_blocks) : 1.0;
}

std::uint32_t MemoryConfig::longest_entry(std::size_t most) const noexcept {
  if (memory == Memory::kInfinite) return BlockEntries<ScaleFactors, kEntries>::kNeverFull;
  // The ring covers the window, or five time constants.
  const double covered = memory == Memory::kWindow ? memory_blocks : 5.0 * memory_blocks;
  return std::bit_ceil(
      static_cast<std::uint32_t>(std::max(1.0, std::ceil(covered / static_cast<double>(most)))));
}

BlockStore::BlockStore(const Config& config) noexcept
    : config_{config}, entries_{entries_for(config)} {}

BlockStore::Entries BlockStore::entries_for(const Config& config) noexcept {
  const std::uint32_t longest = config.longest_entry(kEntries);
  if (config.memory != Memory::kWindow) return Entries{longest};
  return Entries{longest, static_cast<std::size_t>(std::ceil(config.memory_blocks / longest))};
}

void BlockStore::absorb(std::int64_t block, std::size_t scale, const GalerkinRow& row) noexcept {
  Panel& panel = panels_[scale];
  if (panel.count == kPanel || panel.slot != Waiting::slot(block)) absorb_panel(scale);
  panel.slot = Waiting::slot(block);
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
  for (const double n : open_[Waiting::slot(block)].rows) sum += n;
  return sum;
}

void BlockStore::close(std::int64_t block) noexcept {
  if (rows(block) == 0.0 || waiting_.full()) return;
  waiting_.push(Waiting::slot(block));
  if (phase_ == Phase::kIdle) start();
}

void BlockStore::start() noexcept {
  open_[waiting_.first()].blocks = 1;
  if (config_.memory == Memory::kForgetting) {
    const double keep = config_.kept();
    for (RowFactor& f : total_.factor) f.scale(std::sqrt(keep));
    for (double& n : total_.rows) n *= keep;
  }
  entries_.begin();
  phase_ = Phase::kIntoEntry;
}

bool BlockStore::into_total(const ScaleFactors& from) noexcept {
  cursor_ += total_.merge(from, cursor_);
  if (cursor_ < ScaleFactors::kParts) return false;
  total_.merge_counts(from);
  return true;
}

void BlockStore::advance() noexcept {
  ScaleFactors& from = open_[waiting_.first()];
  if (phase_ == Phase::kIntoEntry) {
    for (std::size_t s = 0; s < kScales; ++s)  // a scale's last rows when its factor is needed
      if (panels_[s].slot == waiting_.first() && entries_.adds(static_cast<int>(s) * kRowColumns))
        absorb_panel(s);
    if (!entries_.step(from)) return;
    cursor_ = 0;
    phase_ = Phase::kIntoTotal;
    return;
  }
  if (!into_total(from)) return;
  from.clear();
  phase_ = Phase::kIdle;
  waiting_.pop();
  if (!waiting_.empty()) start();
}

void BlockStore::step() noexcept {
  for (int i = 0; i < kMergesPerStep && phase_ != Phase::kIdle; ++i) advance();
}

void BlockStore::finish() noexcept {
  while (phase_ != Phase::kIdle) advance();
}

void BlockStore::merge_entries(ScaleFactors& out) const noexcept {
  out.clear();
  for (std::size_t i = 0; i < entries_.size(); ++i) out.merge(entries_[i]);
}

void BlockStore::total_to(ScaleFactors& out) const noexcept {
  if (config_.memory == Memory::kWindow)
    merge_entries(out);
  else
    out = total_;
}

std::size_t BlockStore::entries_to(std::array<const ScaleFactors*, kEntries>& out) const noexcept {
  for (std::size_t i = 0; i < entries_.size(); ++i) out[i] = &entries_[i];
  return entries_.size();
}

void BlockStore::clear() noexcept {
  finish();
  total_.clear();
  entries_.clear();
}

}  // namespace dampline

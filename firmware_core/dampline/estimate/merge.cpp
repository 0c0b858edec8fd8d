// SPDX-License-Identifier: MIT
#include "dampline/estimate/merge.hpp"

#include <algorithm>

#include "dampline/numeric/blocks.hpp"

namespace dampline {
namespace {

/// Joins neighbouring entries two by two: half as many, twice as long.
void halve(Statistics& statistics) noexcept {
  statistics.header.entry_count = static_cast<std::uint32_t>(
      join_neighbours(statistics.entries, statistics.header.entry_count,
                      [](ScaleFactors& entry, const ScaleFactors& next) { entry.merge(next); }));
  statistics.header.blocks_per_entry *= 2;
}

/// True when the last entry was shorter than the others by enough to take this one in.
bool join(Statistics& into, const ScaleFactors& entry) noexcept {
  const std::uint32_t count = into.header.entry_count;
  if (count == 0) return false;
  ScaleFactors& last = into.entries[count - 1];
  if (last.blocks + entry.blocks > into.header.blocks_per_entry) return false;
  last.merge(entry);
  return true;
}

/// Joins an entry to the last one or appends it, and halves the entries where they are all full.
void append(Statistics& into, const ScaleFactors& entry) noexcept {
  if (join(into, entry)) return;
  if (into.header.entry_count == kEntries) {
    halve(into);
    if (join(into, entry)) return;
  }
  into.entries[into.header.entry_count++] = entry;
}

void add_velocity(VelocityCounts& into, const VelocityCounts& from) noexcept {
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    into.positive[i] += from.positive[i];
    into.negative[i] += from.negative[i];
  }
  into.moving += from.moving;
  into.sticking += from.sticking;
  into.sum_squares += from.sum_squares;
}

void add_counts(Counts& into, const Counts& from) noexcept {
  into.samples += from.samples;
  into.gaps += from.gaps;
  into.lost += from.lost;
  into.saturated += from.saturated;
  into.stuck += from.stuck;
  into.not_finite += from.not_finite;
  into.repeated += from.repeated;
  into.blocks += from.blocks;
  into.blocks_excluded += from.blocks_excluded;
  into.blocks_still += from.blocks_still;
  into.rows += from.rows;
  into.rows_still += from.rows_still;
}

}  // namespace

Result<std::uint32_t> merge(Statistics& into, const Statistics& from) noexcept {
  if (into.header.basis_hash != from.header.basis_hash) return Errc::kMismatch;
  into.total.merge(from.total);
  while (into.header.blocks_per_entry < from.header.blocks_per_entry) halve(into);
  for (std::uint32_t i = 0; i < from.header.entry_count; ++i) append(into, from.entries[i]);
  add_velocity(into.header.velocity, from.header.velocity);
  add_counts(into.header.counts, from.header.counts);
  into.header.noise_mps2 = std::max(into.header.noise_mps2, from.header.noise_mps2);
  into.header.newest_tick = std::max(into.header.newest_tick, from.header.newest_tick);
  return into.total.blocks;
}

}  // namespace dampline

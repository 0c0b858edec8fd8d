// SPDX-License-Identifier: MIT
#include "drivers/gpiod/edge_ledger.hpp"

#include <algorithm>

namespace dampline::drivers {

EdgeLedger::EdgeLedger(const EdgeConfig& config, bool numbered) : run_time_{config.run_time} {
  lines_.reserve(config.lines.size());
  for (const EdgeLine& line : config.lines) {
    lines_.push_back({.alternates = line.rising && line.falling});
  }
  if (numbered) health_.lost = 0;
}

std::uint32_t EdgeLedger::lost_before(const Line& line, const KernelEdge& edge) noexcept {
  if (!edge.number) return 0;
  const std::uint32_t gap = *edge.number - line.number - 1;  // modulo 2^32, as the kernel counts
  constexpr std::uint32_t kHalf = 1U << 31U;
  return gap < kHalf ? gap : 0;  // a number that stands still or goes back tells of no loss
}

hal::Edge EdgeLedger::enter(const KernelEdge& edge) noexcept {
  Line& line = lines_[edge.line];
  const std::uint32_t lost = lost_before(line, edge);
  // Lost edges alternated too: their number says which one must follow.
  const bool expected = (lost % 2 == 0) != line.rising;
  const bool impossible = line.alternates && line.seen && edge.rising != expected;
  if (line.seen && edge.monotonic_ns < line.monotonic_ns) ++health_.reordered;
  const std::int64_t time_ns =
      line.seen ? std::max(line.monotonic_ns, edge.monotonic_ns) : edge.monotonic_ns;

  ++health_.edges;
  if (impossible) ++health_.impossible;
  if (health_.lost) *health_.lost += lost;
  line.seen = true;
  line.rising = edge.rising;
  line.monotonic_ns = time_ns;
  if (edge.number) line.number = *edge.number;
  return {.time_ns = run_time_.from_monotonic(time_ns),
          .line = edge.line,
          .rising = edge.rising,
          .impossible = impossible,
          .lost_before = lost};
}

}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dampline/basis/columns.hpp"
#include "dampline/basis/window_bank.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

/// One information factor per scale, and how many rows and blocks it holds.
struct ScaleFactors {
  std::array<RowFactor, kScales> factor{};
  std::array<double, kScales> rows{};  ///< a real number: forgetting makes fractions of rows
  std::uint32_t blocks{0};

  void clear() noexcept {
    for (RowFactor& f : factor) f.clear();
    rows.fill(0.0);
    blocks = 0;
  }
  /// As BlockEntries gathers them: one row of one factor; a whole factor where this one is empty.
  static constexpr int kParts = static_cast<int>(kScales) * kRowColumns;
  int merge(const ScaleFactors& from, int part) noexcept;
  void merge_counts(const ScaleFactors& from) noexcept;
  void merge(const ScaleFactors& from) noexcept;
  void copy(const ScaleFactors& from, int part) noexcept {
    const auto scale = static_cast<std::size_t>(part / kRowColumns);
    if (part % kRowColumns == 0) factor[scale] = from.factor[scale];
  }
  void copy_counts(const ScaleFactors& from) noexcept {
    rows = from.rows;
    blocks = from.blocks;
  }
};

/// Velocity of the samples that moved: support of the curve, and what the verdicts need.
struct VelocityCounts {
  std::array<std::uint64_t, kCurveSegments> positive{};  ///< by nearest node
  std::array<std::uint64_t, kCurveSegments> negative{};
  std::uint64_t moving{0};
  std::uint64_t sticking{0};  ///< of these, |v| < 2 mm/s
  double sum_squares{0.0};    ///< (m/s)^2
};

inline constexpr std::size_t kEntries = 28;

/// What the statistics are about, and everything in them that is small.
struct StatisticsHeader {
  std::uint64_t basis_hash{0};  ///< windows, rate, widths, nodes, velocity corner
  double sample_rate_hz{0.0};
  double velocity_corner_hz{0.0};
  std::array<double, kCurveSegments> curve_nodes_mps{};
  std::uint32_t entry_count{0};
  std::uint32_t blocks_per_entry{1};
  VelocityCounts velocity;
  double noise_mps2{0.0};  ///< sensor noise of one channel, rms
  std::int64_t newest_tick{0};
  Counts counts;
};

/// The sufficient statistics of a run: from these alone, every result follows. Statistics of the
/// same basis merge: information and counts add.
struct Statistics {
  StatisticsHeader header;
  ScaleFactors total;
  /// Groups of consecutive blocks, oldest first: deviations and held-out errors come from them.
  std::array<ScaleFactors, kEntries> entries{};
};

/// Entries where they lie, oldest first.
using EntryList = std::span<const ScaleFactors* const>;

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/rig/rig_solution.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

struct RigEstimate {
  RigParameter parameter{RigParameter::kOffset};
  Estimate estimate;
};

/// Samples, blocks and rows that were taken in or left out. Monotone, but for blocks.
struct RigCounts {
  std::uint64_t samples{0};     ///< given to update()
  std::uint64_t gaps{0};        ///< jumps of the tick
  std::uint64_t lost{0};        ///< ticks that were jumped over
  std::uint64_t repeated{0};    ///< tick not larger than the one before; ignored
  std::uint64_t not_finite{0};  ///< a channel is NaN or infinite
  std::uint64_t rows{0};        ///< equations that were used
  std::uint64_t rows_still{0};  ///< dropped: mostly standstill
  std::uint64_t blocks{0};      ///< that hold rows, of equal length
};

/// Number of points of a rig's curve: each branch from v = 0 over its eight nodes.
inline constexpr std::size_t kRigCurvePoints = 2 * (kCurveSegments + 1);

struct RigCurve {
  bool valid{false};
  std::size_t size{0};  ///< points in use: a node that the motion never reached has none
  /// Ascending velocity; v = 0 appears twice, for the negative and for the positive branch.
  std::array<CurvePoint, kRigCurvePoints> points{};
};

/// Everything known at one moment. Made on demand from the blocks.
struct RigSnapshot {
  bool valid{false};  ///< false: too little data, or an unknown that one fold alone determines
  std::size_t size{0};
  std::array<RigEstimate, kMaxRigUnknowns> estimates{};  ///< the unknowns that the data determine
  double nmse{0.0};           ///< of the rows: force seen through the test function
  double held_out_nmse{0.0};  ///< the same, five interleaved folds of blocks
  double residual_n{0.0};
  RigCurve curve;
  RigCounts counts;
};

}  // namespace dampline

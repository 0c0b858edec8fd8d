// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/rig/columns.hpp"
#include "dampline/rig/config.hpp"
#include "dampline/rig/fit.hpp"
#include "dampline/rig/motion.hpp"
#include "dampline/snapshot.hpp"

namespace dampline::rig {

struct ParameterEstimate {
  Parameter parameter{Parameter::kOffset};
  Estimate estimate;
};

/// Samples, blocks and rows that were taken in or left out. Monotone, but for blocks.
struct Counts {
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
inline constexpr std::size_t kCurvePoints = 2 * (kCurveSegments + 1);

struct Curve {
  bool valid{false};
  std::size_t size{0};  ///< points in use: a node that the motion never reached has none
  /// Ascending velocity; v = 0 appears twice, for the negative and for the positive branch.
  std::array<CurvePoint, kCurvePoints> points{};
};

/// Everything known at one moment. Made on demand from the blocks.
struct Snapshot {
  bool valid{false};  ///< false: too little data, or an unknown that one fold alone determines
  std::size_t size{0};
  std::array<ParameterEstimate, kMaxUnknowns>
      estimates{};            ///< the unknowns that the data determine
  double nmse{0.0};           ///< of the rows: force seen through the test function
  double held_out_nmse{0.0};  ///< the same, five interleaved folds of blocks
  double residual_n{0.0};
  Curve curve;
  Counts counts;
};

/// Point of the curve that is nearest to a velocity, on the velocity's own branch.
[[nodiscard]] std::size_t nearest_point(const Config& config, double velocity_mps) noexcept;

/// Both branches of the broken line from a solution of Model::curve().
[[nodiscard]] Curve curve_of(const Solution& solution, const Config& config,
                             const std::array<std::uint64_t, kCurvePoints>& support) noexcept;

enum class Status : std::uint8_t { kUsed, kGap, kRepeated, kNotFinite };

/// What a rig's measured force consists of, from measured motion: mass, spring, friction, damping
/// and offset with standard deviations, and both branches of the damping curve.
///
/// Equations are weak (Rows), information is kept per block for all models at once
/// (BlockStore), and a model is solved for on demand: terms can be added, removed and compared
/// without the data. A gap or a value that is no number ends the open equations; nothing is
/// interpolated.
class Identifier {
 public:
  /// Precondition: check(config).ok().
  explicit Identifier(const Config& config) noexcept;

  Status update(const Sample& sample) noexcept;

  /// Precondition: check(terms).ok().
  [[nodiscard]] Snapshot snapshot(const Terms& terms) const noexcept;
  /// The fit itself, for predictions.
  [[nodiscard]] Solution solution(const Terms& terms) const noexcept;

  [[nodiscard]] const Config& config() const noexcept { return config_; }
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }
  [[nodiscard]] std::int64_t block_samples() const noexcept { return store_.block_samples(); }
  /// Samples from a reading until the last row that it belongs to is complete.
  [[nodiscard]] int latency_samples() const noexcept;

 private:
  [[nodiscard]] Status classify(const Sample& sample) noexcept;
  void take(const Motion& motion) noexcept;

  Config config_;
  MotionEstimator motion_;
  Rows rows_;
  BlockStore store_;
  Counts counts_;
  std::array<std::uint64_t, kCurvePoints> support_{};  ///< samples per point of the curve
  std::int64_t first_tick_{0};
  std::int64_t last_tick_{0};
};

}  // namespace dampline::rig

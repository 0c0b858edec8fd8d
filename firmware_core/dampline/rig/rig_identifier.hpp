// SPDX-License-Identifier: MIT
#pragma once
#include "dampline/rig/rig_block_store.hpp"
#include "dampline/rig/rig_config.hpp"
#include "dampline/rig/rig_motion.hpp"
#include "dampline/rig/rig_rows.hpp"
#include "dampline/rig/rig_sample.hpp"
#include "dampline/rig/rig_snapshot.hpp"

namespace dampline {

enum class RigStatus : std::uint8_t { kUsed, kGap, kRepeated, kNotFinite };

/// What a rig's measured force consists of, from measured motion: mass, spring, friction, damping
/// and offset with standard deviations, and both branches of the damping curve.
///
/// Equations are weak (RigRows), information is kept per block for all models at once
/// (RigBlockStore), and a model is solved for on demand: terms can be added, removed and compared
/// without the data. A gap or a value that is no number ends the open equations; nothing is
/// interpolated.
class RigIdentifier {
 public:
  /// Precondition: check(config).ok().
  explicit RigIdentifier(const RigConfig& config) noexcept;

  RigStatus update(const RigSample& sample) noexcept;

  /// Precondition: check(terms).ok().
  [[nodiscard]] RigSnapshot snapshot(const RigTerms& terms) const noexcept;
  /// The fit itself, for predictions.
  [[nodiscard]] RigSolution solution(const RigTerms& terms) const noexcept;

  [[nodiscard]] const RigConfig& config() const noexcept { return config_; }
  [[nodiscard]] const RigCounts& counts() const noexcept { return counts_; }
  [[nodiscard]] std::int64_t block_samples() const noexcept { return store_.block_samples(); }
  /// Samples from a reading until the last row that it belongs to is complete.
  [[nodiscard]] int latency_samples() const noexcept;

 private:
  [[nodiscard]] RigStatus classify(const RigSample& sample) noexcept;
  [[nodiscard]] bool finite(const RigSample& sample) const noexcept;
  void restart() noexcept;
  void take(const RigMotion& motion) noexcept;

  RigConfig config_;
  RigMotionEstimator motion_;
  RigRows rows_;
  RigBlockStore store_;
  RigCounts counts_;
  std::array<std::uint64_t, kRigCurvePoints> support_{};  ///< samples per point of the curve
  std::int64_t first_tick_{0};
  std::int64_t last_tick_{0};
};

}  // namespace dampline

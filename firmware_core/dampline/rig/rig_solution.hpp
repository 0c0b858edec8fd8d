// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/rig/rig_block_store.hpp"
#include "dampline/rig/rig_model.hpp"
#include "dampline/rig/small_factor.hpp"

namespace dampline {

inline constexpr std::size_t kRigFolds = 5;

/// Least squares of one model over all blocks.
struct RigSolution {
  using Matrix = Eigen::Matrix<double, kMaxRigUnknowns, kMaxRigUnknowns>;

  bool valid{false};  ///< false: too little data, nothing below holds
  RigModel model;     ///< without the unknowns that the data do not determine
  SmallFactor::Vector theta{};
  std::array<SmallFactor::Vector, kRigFolds> theta_without{};  ///< fitted without fold i
  Matrix covariance{Matrix::Zero()};                           ///< of theta
  double nmse{0.0};                                            ///< of the rows
  double held_out_nmse{0.0};  ///< of the rows, each by the fit without its fold
  double residual_n{0.0};     ///< rms over rows
  std::uint32_t blocks{0};    ///< that hold rows

  /// Standard deviation of weights' theta, for derived values.
  [[nodiscard]] double std_of(const SmallFactor::Vector& weights) const noexcept;
};

/// Fold of a block. Each five neighbours go to the five folds, in an order that changes from five
/// to five: with a fixed order, a periodic motion could put one direction into one fold.
[[nodiscard]] constexpr std::size_t fold_of(std::size_t block) noexcept {
  std::uint64_t mix = (block / kRigFolds + 1) * 0x9e3779b97f4a7c15U;  // Fibonacci hashing
  mix ^= mix >> 29U;
  mix *= 0xbf58476d1ce4e5b9U;
  return (block + static_cast<std::size_t>(mix >> 40U)) % kRigFolds;
}

/// Solves; unknowns without support are removed first. Covariance: sandwich of block scores with
/// Bartlett weights, lag 4 (B / 100)^(2/9) (Newey and West, Econometrica 55 (1987) 703), so that
/// residuals that are correlated over a few blocks are counted as such.
[[nodiscard]] RigSolution solve(const RigBlockStore& store, const RigModel& model) noexcept;

}  // namespace dampline

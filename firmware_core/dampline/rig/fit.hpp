// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/blocks.hpp"
#include "dampline/numeric/information.hpp"
#include "dampline/rig/columns.hpp"

namespace dampline::rig {

/// The square-root information of one model.
using ModelInformation = RunTimeInformation<kMaxUnknowns>;

enum class Parameter : std::uint8_t {
  kMovingMass,
  kStiffness,
  kViscous,
  kViscousPositive,
  kViscousNegative,
  kCoulomb,
  kCoulombPositive,
  kCoulombNegative,
  kOffset,
  kSlope,  ///< of one segment of the broken line
};

/// A model as columns of the equations: unknown j multiplies the row times column(j).
class Model {
 public:
  using Column = Eigen::Matrix<double, column::kCount, 1>;

  Model() = default;  ///< no unknowns
  explicit Model(const Terms& terms) noexcept;
  /// The broken line on both branches instead of the dissipative terms. Its levels at v = 0 contain
  /// a constant force.
  [[nodiscard]] static Model curve(const Terms& terms) noexcept;

  [[nodiscard]] int size() const noexcept { return size_; }
  [[nodiscard]] Parameter parameter(int j) const noexcept { return id_[as_size(j)]; }
  [[nodiscard]] const Column& column(int j) const noexcept { return columns_[as_size(j)]; }
  void remove(int j) noexcept;

  /// The value of unknown j's column in `row`.
  [[nodiscard]] double value(int j, const Block::Row& row) const noexcept {
    return column(j).dot(row);
  }

 private:
  static std::size_t as_size(int j) noexcept { return static_cast<std::size_t>(j); }
  Column& add(Parameter id) noexcept;
  void add_linear(const Terms& terms) noexcept;
  void add_viscous(Branches branches) noexcept;
  void add_coulomb(Branches branches) noexcept;

  int size_{0};
  std::array<Parameter, kMaxUnknowns> id_{};
  std::array<Column, kMaxUnknowns> columns_{};
};

/// One factor per stretch of time, in fixed memory for any length of record: when the store is
/// full, neighbours merge and the stretches double. 64 to 128 blocks of equal length remain, one of
/// them still filling.
class BlockStore {
 public:
  static constexpr std::size_t kMaxBlocks = 128;

  explicit BlockStore(std::int64_t block_samples) noexcept : block_samples_{block_samples} {}

  /// Adds a row to the block that holds its centre. Ticks count from 0.
  void absorb(std::int64_t tick, const Block::Row& row) noexcept {
    while (block_of(tick) >= kMaxBlocks) halve();
    const std::size_t block = block_of(tick);
    if (block + 1 > size_) size_ = block + 1;
    blocks_[block].absorb(row);
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] const Block& block(std::size_t i) const noexcept { return blocks_[i]; }
  [[nodiscard]] std::int64_t block_samples() const noexcept { return block_samples_; }
  [[nodiscard]] std::size_t block_of(std::int64_t tick) const noexcept {
    return static_cast<std::size_t>(tick / block_samples_);
  }

 private:
  void halve() noexcept {
    join_neighbours(blocks_, kMaxBlocks,
                    [](Block& block, const Block& next) { block.merge(next); });
    for (std::size_t i = kMaxBlocks / 2; i < kMaxBlocks; ++i) blocks_[i].clear();
    size_ = (size_ + 1) / 2;
    block_samples_ *= 2;
  }

  std::int64_t block_samples_;
  std::size_t size_{0};
  std::array<Block, kMaxBlocks> blocks_{};
};

inline constexpr std::size_t kFolds = 5;

/// Least squares of one model over all blocks.
struct Solution {
  using Matrix = Eigen::Matrix<double, kMaxUnknowns, kMaxUnknowns>;

  bool valid{false};  ///< false: too little data, nothing below holds
  Model model;        ///< without the unknowns that the data do not determine
  ModelInformation::Vector theta{};
  std::array<ModelInformation::Vector, kFolds> theta_without{};  ///< fitted without fold i
  Matrix covariance{Matrix::Zero()};                             ///< of theta
  double nmse{0.0};                                              ///< of the rows
  double held_out_nmse{0.0};  ///< of the rows, each by the fit without its fold
  double residual_n{0.0};     ///< rms over rows
  std::uint32_t blocks{0};    ///< that hold rows

  /// Standard deviation of weights' theta, for derived values.
  [[nodiscard]] double std_of(const ModelInformation::Vector& weights) const noexcept;
};

/// Fold of a block. Each five neighbours go to the five folds, in an order that changes from five
/// to five: with a fixed order, a periodic motion could put one direction into one fold.
[[nodiscard]] constexpr std::size_t fold_of(std::size_t block) noexcept {
  std::uint64_t mix = (block / kFolds + 1) * 0x9e3779b97f4a7c15U;  // Fibonacci hashing
  mix ^= mix >> 29U;
  mix *= 0xbf58476d1ce4e5b9U;
  return (block + static_cast<std::size_t>(mix >> 40U)) % kFolds;
}

/// Solves; unknowns without support are removed first. Covariance: sandwich of block scores with
/// Bartlett weights, lag 4 (B / 100)^(2/9) (Newey and West, Econometrica 55 (1987) 703), so that
/// residuals that are correlated over a few blocks are counted as such.
[[nodiscard]] Solution solve(const BlockStore& store, const Model& model) noexcept;

}  // namespace dampline::rig

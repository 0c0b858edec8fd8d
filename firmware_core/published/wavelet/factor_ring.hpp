// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "published/wavelet/linear_estimate.hpp"

namespace dampline {

/// A sliding window: the factors of the latest `Blocks` blocks of rows, merged on demand. The
/// oldest block leaves as a whole, so nothing is ever subtracted. The window holds between (Blocks
/// - 1) rows_per_block + 1 and Blocks rows_per_block rows. update() costs Blocks (Unknowns + 1)
/// absorbed rows, absorb() one.
template <int Unknowns, std::size_t Blocks, class Scalar = double>
class FactorRing {
  static_assert(Blocks >= 2);

 public:
  using Factor = Information<Unknowns + 1, Scalar>;

  explicit FactorRing(std::int64_t rows_per_block, const Sufficiency& enough = {}) noexcept
      : rows_per_block_{rows_per_block}, enough_{enough} {}

  void absorb(const typename Factor::Row& row) noexcept {
    if (rows_[newest_] == rows_per_block_) {
      newest_ = (newest_ + 1) % Blocks;
      factors_[newest_].clear();
      rows_[newest_] = 0;
    }
    factors_[newest_].absorb(row);
    ++rows_[newest_];
  }

  /// Merges the blocks and solves. False, and latest() held, where the rows do not suffice.
  [[nodiscard]] bool update() noexcept { return solve(merged(), rows(), enough_, latest_); }

  /// The information of all rows in the window.
  [[nodiscard]] Factor merged() const noexcept {
    Factor out = factors_[newest_];
    for (std::size_t i = 1; i < Blocks; ++i) out.merge(factors_[(newest_ + i) % Blocks]);
    return out;
  }
  [[nodiscard]] double rows() const noexcept {
    std::int64_t sum = 0;
    for (const std::int64_t n : rows_) sum += n;
    return static_cast<double>(sum);
  }
  [[nodiscard]] const LinearEstimate<Unknowns, Scalar>& latest() const noexcept { return latest_; }

 private:
  std::int64_t rows_per_block_;
  Sufficiency enough_;
  std::array<Factor, Blocks> factors_{};
  std::array<std::int64_t, Blocks> rows_{};
  std::size_t newest_{0};
  LinearEstimate<Unknowns, Scalar> latest_{};
};

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/blocks.hpp"
#include "dampline/numeric/information.hpp"

namespace dampline {

/// Which unknowns of a model take part; the others are zero.
template <int Unknowns>
using TermMask = std::array<bool, static_cast<std::size_t>(Unknowns)>;

/// The information of consecutive blocks of instants, per equation of the model. When all blocks
/// are full, neighbours join two by two and blocks are twice as long from then on: any run fits.
template <int Dof, int Unknowns>
class ModelBlocks {
 public:
  static constexpr std::size_t kBlocks = 16;
  using Factor = Information<Unknowns + 1>;
  using Factors = std::array<Factor, static_cast<std::size_t>(Dof)>;
  using Vector = typename Factor::Vector;

  explicit ModelBlocks(std::int64_t instants_per_block) noexcept : length_{instants_per_block} {}

  /// Begins the next instant; its equations follow by absorb().
  void begin_instant() noexcept {
    if (count_ == 0 || instants_[count_ - 1] == length_) open();
    ++instants_[count_ - 1];
  }
  void absorb(std::size_t dof, const typename Factor::Row& row) noexcept {
    blocks_[count_ - 1][dof].absorb(row);
  }

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] const Factors& block(std::size_t i) const noexcept { return blocks_[i]; }

  /// The information about the masked unknowns of the blocks for which `takes(block)`, all
  /// equations together. Columns of other unknowns are zero.
  template <class Takes>
  [[nodiscard]] Factor sum(const TermMask<Unknowns>& mask, const Takes& takes) const noexcept {
    Factor out;
    for (std::size_t b = 0; b < count_; ++b) {
      if (!takes(b)) continue;
      for (const Factor& factor : blocks_[b]) add_masked(factor, mask, out);
    }
    return out;
  }

  /// Solves for the masked unknowns; false where they are not determined.
  [[nodiscard]] static bool solve(const Factor& factor, const TermMask<Unknowns>& mask,
                                  Vector& theta, double tolerance = 1e-9) noexcept {
    theta.setZero();
    for (int i = Unknowns - 1; i >= 0; --i) {
      if (!mask[static_cast<std::size_t>(i)]) continue;
      if (!(factor.at(i, i) > tolerance * factor.column_norm(i))) return false;
      double sum = factor.at(i, Unknowns);
      for (int j = i + 1; j < Unknowns; ++j) sum -= factor.at(i, j) * theta[j];
      theta[i] = sum / factor.at(i, i);
    }
    return true;
  }

  /// |A theta - b|^2 of one equation over one block.
  [[nodiscard]] double residual(std::size_t b, std::size_t dof,
                                const Vector& theta) const noexcept {
    double sum = 0.0;
    for (int i = 0; i <= Unknowns; ++i) {
      double r = -blocks_[b][dof].at(i, Unknowns);
      for (int j = i; j < Unknowns; ++j) r += blocks_[b][dof].at(i, j) * theta[j];
      sum += r * r;
    }
    return sum;
  }

 private:
  static void add_masked(const Factor& from, const TermMask<Unknowns>& mask, Factor& out) noexcept {
    for (int i = 0; i <= Unknowns; ++i) {
      typename Factor::Row row = from.row(i);
      for (int j = 0; j < Unknowns; ++j) {
        if (!mask[static_cast<std::size_t>(j)]) row[j] = 0.0;
      }
      out.absorb(row, i);
    }
  }

  void open() noexcept {
    if (count_ == kBlocks) halve();
    if (count_ > 0 && instants_[count_ - 1] < length_) return;
    blocks_[count_] = Factors{};
    instants_[count_++] = 0;
  }

  void halve() noexcept {
    join_neighbours(instants_, kBlocks, [](auto& block, auto next) { block += next; });
    count_ = join_neighbours(blocks_, kBlocks, [](Factors& block, const Factors& next) {
      for (std::size_t d = 0; d < block.size(); ++d) block[d].merge(next[d]);
    });
    length_ *= 2;
  }

  std::array<Factors, kBlocks> blocks_{};
  std::array<std::int64_t, kBlocks> instants_{};
  std::size_t count_{0};
  std::int64_t length_;
};

}  // namespace dampline

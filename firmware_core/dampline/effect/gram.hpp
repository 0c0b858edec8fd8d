// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/basis/window_bank.hpp"
#include "dampline/effect/columns.hpp"

namespace dampline::effect {

using Row = Eigen::Matrix<double, kColumns, 1>;

/// Sums of products of all columns: the packed upper triangle of [A t]'[A t].
class Gram {
 public:
  static constexpr std::size_t kSize = static_cast<std::size_t>(kColumns) * (kColumns + 1) / 2;

  void absorb(const Row& row) noexcept {
    double* out = sum_.data();
    for (int i = 0; i < kColumns; ++i) {
      const double x = row[i];
      for (int j = i; j < kColumns; ++j) *out++ += x * row[j];
    }
  }
  void add(const Gram& other, double weight = 1.0) noexcept {
    for (std::size_t i = 0; i < kSize; ++i) sum_[i] += weight * other.sum_[i];
  }
  void clear() noexcept { sum_.fill(0.0); }
  [[nodiscard]] double at(int i, int j) const noexcept {
    return i <= j ? sum_[offset(i) + static_cast<std::size_t>(j - i)]
                  : sum_[offset(j) + static_cast<std::size_t>(i - j)];
  }

 private:
  static constexpr std::size_t offset(int i) noexcept {
    return static_cast<std::size_t>(i * kColumns - i * (i - 1) / 2);
  }
  std::array<double, kSize> sum_{};
};

/// One Gram matrix per scale, and how many rows it holds.
struct ScaleGrams {
  std::array<Gram, kScales> gram{};
  std::array<double, kScales> rows{};
  std::uint32_t blocks{0};

  void clear() noexcept {
    for (Gram& g : gram) g.clear();
    rows.fill(0.0);
    blocks = 0;
  }
};

}  // namespace dampline::effect

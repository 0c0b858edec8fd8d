// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "dampline/motion/wide_dot.hpp"

namespace dampline {

/// The latest Size values in one piece, the oldest first. Each is written twice, so that nothing is
/// shifted along.
template <std::size_t Size>
class SlidingWindow {
 public:
  void push(double x) noexcept {
    values_[next_] = values_[next_ + Size] = x;
    if (++next_ == Size) next_ = 0;
  }

  /// Sum of weights[i] x_i, i counted from the oldest; in four lanes.
  [[nodiscard]] double dot(const std::array<double, Size>& weights) const noexcept {
    return wide_dot(weights.data(), values_.data() + next_, Size);
  }

 private:
  std::array<double, 2 * Size> values_{};
  std::size_t next_{0};  // the oldest, which the next replaces
};

}  // namespace dampline

// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>

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

  /// Sum of weights[i] x_i, i counted from the oldest; two by two.
  [[nodiscard]] double dot(const std::array<double, Size>& weights) const noexcept {
    using Pair = Eigen::Array2d;
    const double* x = values_.data() + next_;
    Pair even = Pair::Zero();
    Pair odd = Pair::Zero();
    std::size_t i = 0;
    for (; i + 3 < Size; i += 4) {
      even += Pair::Map(&weights[i]) * Pair::Map(x + i);
      odd += Pair::Map(&weights[i + 2]) * Pair::Map(x + i + 2);
    }
    double rest = 0.0;
    for (; i < Size; ++i) rest += weights[i] * x[i];
    return (even + odd).sum() + rest;
  }

 private:
  std::array<double, 2 * Size> values_{};
  std::size_t next_{0};  // the oldest, which the next replaces
};

}  // namespace dampline

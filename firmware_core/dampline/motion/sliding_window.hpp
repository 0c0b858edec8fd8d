// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "dampline/numeric/wide.hpp"

namespace dampline {

/// The latest Size values in one piece, the oldest first. Each is written twice, so that nothing is
/// shifted along. The newest are kept a third time and read one by one: a processor that is to read
/// four numbers at once waits until the last of them has reached its cache.
template <std::size_t Size>
class SlidingWindow {
 public:
  void push(double x) noexcept {
    values_[next_] = values_[next_ + Size] = x;
    if (++next_ == Size) next_ = 0;
    recent_[++newest_ % kRecent] = x;
  }

  /// Sum of weights[i] x_i, i counted from the oldest, as wide_dot() adds them; part of the caller
  /// for the sizes that are in use.
  [[nodiscard]] double dot(const std::array<double, Size>& weights) const noexcept {
    if constexpr (Size % 8 == 1 && Size > 8)
      return inline_dot(weights.data());
    else
      return wide_dot(weights.data(), values_.data() + next_, Size);
  }

 private:
  [[nodiscard]] double inline_dot(const double* w) const noexcept {
    const double* const x = values_.data() + next_;
    Wide even = wide(w).numbers * wide(x).numbers;
    Wide odd{};
    for (std::size_t i = 4; i + 5 < Size; i += 8) {
      odd += wide(w + i).numbers * wide(x + i).numbers;
      even += wide(w + i + 4).numbers * wide(x + i + 4).numbers;
    }
    odd += wide(w + Size - 5).numbers * Wide{recent(4), recent(3), recent(2), recent(1)};
    const Wide sum = even + odd;
    return (sum[0] + sum[2]) + (sum[1] + sum[3]) + w[Size - 1] * recent(0);
  }

  static constexpr std::size_t kRecent = 8;
  [[nodiscard]] double recent(std::size_t age) const noexcept {
    return recent_[(newest_ - age) % kRecent];
  }
  std::array<double, 2 * Size> values_{};
  std::size_t next_{0};  // the oldest, which the next replaces
  std::array<double, kRecent> recent_{};
  std::size_t newest_{0};
};

}  // namespace dampline

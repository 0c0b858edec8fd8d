// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

/// Before a function: compiled a second time for AVX2, where the loader takes that version on a
/// processor that has it. Both versions do the same operations in the same order on each number
/// (-ffp-contract=off, sums in fixed lanes), so that results are the same bits everywhere. Callees
/// are inlined, since only what is inlined is compiled for the wider vectors. Sanitizers run before
/// the loader has chosen, and clang cannot do this to members: there it means nothing.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define DAMPLINE_WIDE [[gnu::target_clones("avx2", "default"), gnu::flatten]]
#else
#define DAMPLINE_WIDE
#endif

namespace dampline {

/// Four neighbours in memory, aligned as one of them is. As numbers they go through one instruction
/// where the processor has one for so many, else through two or four; lane by lane the same bits.
template <class Number>
struct [[gnu::packed, gnu::aligned(alignof(Number)), gnu::may_alias]] FourInMemory {
  using Numbers [[gnu::vector_size(4 * sizeof(Number))]] = Number;
  Numbers numbers;
};
using Wide = FourInMemory<double>::Numbers;

template <class Number>
inline const FourInMemory<Number>& wide(const Number* first) noexcept {
  return *reinterpret_cast<const FourInMemory<Number>*>(first);
}
template <class Number>
inline FourInMemory<Number>& wide(Number* first) noexcept {
  return *reinterpret_cast<FourInMemory<Number>*>(first);
}

/// Sum of a[i] b[i]: number i goes to lane i % 8, then the lanes are added, and the last count % 4
/// numbers to that; the same bits on every machine.
[[nodiscard]] double wide_dot(const double* a, const double* b, std::size_t count) noexcept;

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
